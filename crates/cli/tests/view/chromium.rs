//! A real browser without a window, steered by the Chrome DevTools Protocol.

use std::io::{BufRead, BufReader};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::TempDir;
use tungstenite::stream::MaybeTlsStream;
use tungstenite::{Message, WebSocket};

/// Names of the browser, `SHIFTVOX_BROWSER` first.
const NAMES: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];
/// The longest wait for a page.
const PATIENCE: Duration = Duration::from_secs(60);

/// A browser, until it goes out of scope.
pub(crate) struct Browser {
    child: Child,
    socket: WebSocket<MaybeTlsStream<TcpStream>>,
    count: u64,
    /// The page that calls are for.
    pub(crate) page: Page,
    /// Errors of pages: errors of scripts, refused resources.
    pub(crate) complaints: Vec<String>,
    _profile: TempDir,
}

/// A page of a browser: its session.
pub(crate) type Page = String;

impl Browser {
    /// Starts one.
    pub(crate) fn start() -> Self {
        let own = std::env::var("SHIFTVOX_BROWSER").ok();
        let names = own.into_iter().chain(NAMES.map(str::to_owned));
        let profile = tempfile::tempdir().unwrap();
        let started = names.into_iter().find_map(|name| {
            Command::new(name)
                .args([
                    "--headless=new",
                    "--no-sandbox",
                    "--disable-gpu",
                    "--disable-dev-shm-usage",
                ])
                .args([
                    "--no-first-run",
                    "--disable-extensions",
                    "--disable-background-networking",
                ])
                .args(["--hide-scrollbars", "--remote-debugging-port=0"])
                .arg(format!("--user-data-dir={}", profile.path().display()))
                .arg("about:blank")
                .stdout(Stdio::null())
                .stderr(Stdio::piped())
                .spawn()
                .ok()
        });
        let mut child = started.expect("chromium, or the browser SHIFTVOX_BROWSER");
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
        let address = lines.by_ref().map_while(Result::ok).find_map(|line| {
            line.strip_prefix("DevTools listening on ")
                .map(str::to_owned)
        });
        let address = address.expect("a browser that starts");
        // The rest of its output is read, so that it does not block.
        std::thread::spawn(move || lines.map_while(Result::ok).count());
        let (socket, _) = tungstenite::connect(address).unwrap();
        if let MaybeTlsStream::Plain(stream) = socket.get_ref() {
            stream.set_read_timeout(Some(PATIENCE)).unwrap();
        }
        Self {
            child,
            socket,
            count: 0,
            page: Page::new(),
            complaints: Vec::new(),
            _profile: profile,
        }
    }

    fn call(&mut self, method: &str, parameters: Value) -> Value {
        self.count += 1;
        let mut call = json!({ "id": self.count, "method": method, "params": parameters });
        if !self.page.is_empty() && !method.starts_with("Target.") {
            call["sessionId"] = json!(self.page);
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
            let (method, said) = (message["method"].as_str(), &message["params"]);
            if method == Some("Runtime.exceptionThrown")
                || (method == Some("Log.entryAdded") && said["entry"]["level"] == "error")
            {
                self.complaints.push(said.to_string());
            }
        }
    }

    /// Opens an address in a page of 1200 x 800 pixels, which calls are for from here on.
    pub(crate) fn open(&mut self, address: &str) {
        let target = self.call("Target.createTarget", json!({ "url": "about:blank" }));
        let target = json!({ "targetId": target["targetId"], "flatten": true });
        let session = self.call("Target.attachToTarget", target);
        self.page = session["sessionId"].as_str().unwrap().to_owned();
        for domain in ["Runtime.enable", "Log.enable", "Page.enable"] {
            self.call(domain, json!({}));
        }
        let size = json!({ "width": 1200, "height": 800, "deviceScaleFactor": 1, "mobile": false });
        self.call("Emulation.setDeviceMetricsOverride", size);
        self.call("Page.navigate", json!({ "url": address }));
    }

    /// The value of a script's expression, or of its promise.
    pub(crate) fn value(&mut self, script: &str) -> Value {
        let parameters =
            json!({ "expression": script, "awaitPromise": true, "returnByValue": true });
        let result = self.call("Runtime.evaluate", parameters);
        assert!(result["exceptionDetails"].is_null(), "{script}: {result}");
        result["result"]["value"].clone()
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
            assert!(
                Instant::now() < until,
                "in vain: {script}\n{said}\n{:?}",
                self.complaints
            );
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Presses a button of the mouse, drags and releases it.
    pub(crate) fn drag(&mut self, from: [f64; 2], to: [f64; 2], button: &str) {
        let buttons = if button == "right" { 2 } else { 1 };
        let mut mouse = |kind: &str, [x, y]: [f64; 2], buttons: u32| {
            let event = json!({ "type": kind, "x": x, "y": y, "button": button, "buttons": buttons, "clickCount": 1 });
            self.call("Input.dispatchMouseEvent", event);
        };
        mouse("mousePressed", from, buttons);
        for step in 1..=4 {
            let along = f64::from(step) / 4.0;
            let at = [0, 1].map(|k| from[k] + (to[k] - from[k]) * along);
            mouse("mouseMoved", at, buttons);
        }
        mouse("mouseReleased", to, 0);
    }

    /// Turns the mouse's wheel.
    pub(crate) fn wheel(&mut self, [x, y]: [f64; 2], by: f64) {
        let event = json!({ "type": "mouseWheel", "x": x, "y": y, "deltaX": 0, "deltaY": by });
        self.call("Input.dispatchMouseEvent", event);
    }

    /// Presses a key.
    pub(crate) fn key(&mut self, key: &str) {
        for kind in ["keyDown", "keyUp"] {
            self.call(
                "Input.dispatchKeyEvent",
                json!({ "type": kind, "key": key }),
            );
        }
    }

    /// Moves fingers: each list has their places at one time.
    pub(crate) fn touch(&mut self, places: &[Vec<[f64; 2]>]) {
        let mut touch = |kind: &str, points: &[[f64; 2]]| {
            let points: Vec<Value> = points
                .iter()
                .map(|[x, y]| json!({ "x": x, "y": y }))
                .collect();
            let event = json!({ "type": kind, "touchPoints": points });
            self.call("Input.dispatchTouchEvent", event);
        };
        touch("touchStart", &places[0]);
        for points in &places[1..] {
            touch("touchMove", points);
        }
        touch("touchEnd", &[]);
    }

    /// A picture of a page, at 0.6 of its size, base64.
    pub(crate) fn screenshot(&mut self) -> String {
        let clip = json!({ "x": 0, "y": 0, "width": 1200, "height": 800, "scale": 0.6 });
        let parameters = json!({ "format": "png", "clip": clip });
        let shot = self.call("Page.captureScreenshot", parameters);
        shot["data"].as_str().unwrap().to_owned()
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self
            .socket
            .send(Message::text(r#"{"id":0,"method":"Browser.close"}"#));
        let until = Instant::now() + Duration::from_secs(3);
        while matches!(self.child.try_wait(), Ok(None)) && Instant::now() < until {
            std::thread::sleep(Duration::from_millis(20));
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
