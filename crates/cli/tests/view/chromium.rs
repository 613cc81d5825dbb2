//! A real browser without a window, steered by the Chrome DevTools Protocol.

use std::io::{BufRead, BufReader};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};
use tempfile::TempDir;
use tungstenite::stream::MaybeTlsStream;
use tungstenite::{Message, WebSocket};

/// Names of the browser, `SHIFTVOX_BROWSER` first.
const NAMES: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];
const FLAGS: &str = "--headless=new --no-sandbox --disable-gpu --disable-dev-shm-usage --no-first-run \
                     --disable-extensions --disable-background-networking --hide-scrollbars \
                     --remote-debugging-port=0 about:blank";
/// The longest wait for a page.
const PATIENCE: Duration = Duration::from_secs(60);

/// A browser with a page of 1200 x 800 pixels, until it goes out of scope.
pub(crate) struct Browser {
    child: Child,
    socket: WebSocket<MaybeTlsStream<TcpStream>>,
    count: u64,
    /// The session of the page.
    page: Option<String>,
    /// Errors of the page: errors of scripts, refused resources. There are none at the end of a test that passes.
    pub(crate) complaints: Vec<String>,
    _profile: TempDir,
}

impl Browser {
    /// Opens an address.
    pub(crate) fn open(address: &str) -> Self {
        let own = std::env::var("SHIFTVOX_BROWSER").ok();
        let names = own.into_iter().chain(NAMES.map(str::to_owned));
        let profile = tempfile::tempdir().unwrap();
        let started = names.into_iter().find_map(|name| {
            let mut command = Command::new(name);
            command.arg(format!("--user-data-dir={}", profile.path().display()));
            command.args(FLAGS.split(' '));
            command.stdout(Stdio::null()).stderr(Stdio::piped());
            command.spawn().ok()
        });
        let mut child = started.expect("chromium, or the browser SHIFTVOX_BROWSER");
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
        let socket = lines.by_ref().map_while(Result::ok).find_map(|line| {
            let socket = line.strip_prefix("DevTools listening on ");
            socket.map(str::to_owned)
        });
        // The rest of its output is read, so that it does not block.
        std::thread::spawn(move || lines.map_while(Result::ok).count());
        let (socket, _) = tungstenite::connect(socket.expect("a browser that starts")).unwrap();
        if let MaybeTlsStream::Plain(stream) = socket.get_ref() {
            stream.set_read_timeout(Some(PATIENCE)).unwrap();
        }
        let mut browser = Self {
            child,
            socket,
            count: 0,
            page: None,
            complaints: Vec::new(),
            _profile: profile,
        };
        let target = browser.call("Target.createTarget", json!({ "url": "about:blank" }));
        let target = json!({ "targetId": target["targetId"], "flatten": true });
        let session = browser.call("Target.attachToTarget", target);
        browser.page = session["sessionId"].as_str().map(str::to_owned);
        for domain in ["Runtime.enable", "Log.enable", "Page.enable"] {
            browser.call(domain, json!({}));
        }
        let size = json!({ "width": 1200, "height": 800, "deviceScaleFactor": 1, "mobile": false });
        browser.call("Emulation.setDeviceMetricsOverride", size);
        browser.call("Page.navigate", json!({ "url": address }));
        browser
    }

    fn call(&mut self, method: &str, parameters: Value) -> Value {
        self.count += 1;
        let mut call = json!({ "id": self.count, "method": method, "params": parameters });
        if let Some(page) = &self.page {
            call["sessionId"] = json!(page);
        }
        self.socket.send(Message::text(call.to_string())).unwrap();
        loop {
            let message = self.socket.read().unwrap();
            let Ok(text) = message.to_text() else {
                continue;
            };
            let message: Value = serde_json::from_str(text).unwrap();
            if message["id"] == self.count {
                assert!(message["error"].is_null(), "{method}: {message}");
                return message["result"].clone();
            }
            let said = &message["params"];
            let is_error = said["entry"]["level"] == "error";
            if message["method"] == "Runtime.exceptionThrown" || is_error {
                self.complaints.push(said.to_string());
            }
        }
    }

    /// The value of a script's expression, or of its promise.
    pub(crate) fn value(&mut self, script: &str) -> Value {
        let parameters =
            json!({ "expression": script, "awaitPromise": true, "returnByValue": true });
        let result = self.call("Runtime.evaluate", parameters);
        assert!(result["exceptionDetails"].is_null(), "{script}: {result}");
        result["result"]["value"].clone()
    }

    /// Chooses the value of an element.
    pub(crate) fn set(&mut self, id: &str, value: &str) {
        let script = format!("$('{id}').value = '{value}'; $('{id}').onchange()");
        self.value(&script);
    }

    /// The text that an expression gives.
    pub(crate) fn text(&mut self, script: &str) -> String {
        let value = self.value(script);
        value
            .as_str()
            .unwrap_or_else(|| panic!("{script}: {value}"))
            .to_owned()
    }

    /// Waits until an expression is true.
    pub(crate) fn wait(&mut self, script: &str) {
        let until = Instant::now() + PATIENCE;
        // An element that does not exist yet counts as false.
        let script = format!(
            "(() => {{ try {{ return Boolean({script}); }} catch {{ return false; }} }})()"
        );
        while self.value(&script) != true {
            let said = self.value("document.body?.innerText");
            let complaints = &self.complaints;
            assert!(
                Instant::now() < until,
                "in vain: {script}\n{said}\n{complaints:?}"
            );
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Sends events of a device: `Mouse`, `Key` or `Touch`.
    pub(crate) fn input(&mut self, device: &str, events: impl IntoIterator<Item = Value>) {
        for event in events {
            self.call(&format!("Input.dispatch{device}Event"), event);
        }
    }

    /// Presses a button of the mouse, drags and releases it.
    pub(crate) fn drag(&mut self, from: [f64; 2], to: [f64; 2], button: &str) {
        let held = if button == "right" { 2 } else { 1 };
        let events = (0..=5).map(|step| {
            let along = f64::from(step.min(4)) / 4.0;
            let [x, y] = [0, 1].map(|k| from[k] + (to[k] - from[k]) * along);
            let (kind, buttons) = match step {
                0 => ("mousePressed", held),
                5 => ("mouseReleased", 0),
                _ => ("mouseMoved", held),
            };
            json!({ "type": kind, "x": x, "y": y, "button": button, "buttons": buttons, "clickCount": 1 })
        });
        self.input("Mouse", events);
    }

    /// Makes the page that of a phone, or one of dark colours.
    pub(crate) fn emulate(&mut self, is_phone: bool, is_dark: bool) {
        let [width, height] = if is_phone { [390, 844] } else { [1200, 800] };
        let size =
            json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": is_phone });
        self.call("Emulation.setDeviceMetricsOverride", size);
        let touch = json!({ "enabled": is_phone });
        self.call("Emulation.setTouchEmulationEnabled", touch);
        let scheme = if is_dark { "dark" } else { "light" };
        let scheme = json!({ "features": [{ "name": "prefers-color-scheme", "value": scheme }] });
        self.call("Emulation.setEmulatedMedia", scheme);
    }

    /// Keeps a picture of the page, a wide one at 0.6 of its size, in the folder `SHIFTVOX_SHOTS` if there is one.
    pub(crate) fn shot(&mut self, name: &str) {
        let Some(folder) = std::env::var_os("SHIFTVOX_SHOTS") else {
            return;
        };
        let [width, height] =
            ["innerWidth", "innerHeight"].map(|side| self.value(side).as_f64().unwrap());
        let scale = if width > 1000.0 { 0.6 } else { 1.0 };
        let clip = json!({ "x": 0, "y": 0, "width": width, "height": height, "scale": scale });
        let parameters = json!({ "format": "png", "clip": clip });
        let shot = self.call("Page.captureScreenshot", parameters);
        let bytes = BASE64_STANDARD.decode(shot["data"].as_str().unwrap());
        std::fs::write(std::path::Path::new(&folder).join(name), bytes.unwrap()).unwrap();
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let close = r#"{"id":0,"method":"Browser.close"}"#;
        let _ = self.socket.send(Message::text(close));
        let until = Instant::now() + Duration::from_secs(3);
        while matches!(self.child.try_wait(), Ok(None)) && Instant::now() < until {
            std::thread::sleep(Duration::from_millis(20));
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
        let is_fine = self.complaints.is_empty() || std::thread::panicking();
        assert!(is_fine, "{:?}", self.complaints);
    }
}
