//! The program under test, and a page's end of its sockets.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

use serde_json::{Value, json};
use tungstenite::handshake::client::generate_key;
use tungstenite::http::Request;
use tungstenite::protocol::frame::coding::CloseCode;
use tungstenite::{Message, WebSocket, client};

/// A program that serves pages, until it goes out of scope.
pub(crate) struct Program {
    pub(crate) child: Child,
    pub(crate) address: String,
    pub(crate) port: u16,
    pub(crate) token: String,
}

impl Program {
    /// Starts `shiftvox view` with these words, in the folder of the sources.
    pub(crate) fn start(words: &[&str]) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_shiftvox"))
            .args(["view", "--quiet"])
            .args(words)
            .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut address = String::new();
        let stdout = child.stdout.take().unwrap();
        BufReader::new(stdout).read_line(&mut address).unwrap();
        let address = address.trim().to_owned();
        let (before, token) = address.split_once("/?token=").expect("an address");
        let (_, port) = before.rsplit_once(':').unwrap();
        Self {
            port: port.parse().unwrap(),
            token: token.to_owned(),
            child,
            address,
        }
    }

    /// Sends a request as it is, and returns the answer.
    pub(crate) fn raw(&self, request: &str) -> String {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream
            .set_read_timeout(Some(Duration::from_secs(20)))
            .unwrap();
        stream.write_all(request.as_bytes()).unwrap();
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        String::from_utf8_lossy(&answer).into_owned()
    }

    /// The status of a request for a path with some headers.
    pub(crate) fn status(&self, path: &str, headers: &[&str]) -> u16 {
        let headers: String = headers
            .iter()
            .map(|header| format!("{header}\r\n"))
            .collect();
        let answer = self.raw(&format!(
            "GET {path} HTTP/1.1\r\n{headers}Connection: close\r\n\r\n"
        ));
        let status = answer.split(' ').nth(1);
        status
            .and_then(|code| code.parse().ok())
            .unwrap_or_else(|| panic!("{answer}"))
    }

    /// Opens a socket as the page does, or returns the HTTP status of the refusal.
    pub(crate) fn try_page(&self) -> Result<Page, u16> {
        let host = format!("127.0.0.1:{}", self.port);
        let origin = format!("http://{host}");
        self.socket(&host, Some(&origin), &self.token)
    }

    pub(crate) fn page(&self) -> Page {
        self.try_page().unwrap()
    }

    pub(crate) fn socket(
        &self,
        host: &str,
        origin: Option<&str>,
        token: &str,
    ) -> Result<Page, u16> {
        let mut request = Request::builder()
            .uri(format!("ws://127.0.0.1:{}/socket?token={token}", self.port))
            .header("Host", host)
            .header("Connection", "Upgrade")
            .header("Upgrade", "websocket")
            .header("Sec-WebSocket-Version", "13")
            .header("Sec-WebSocket-Key", generate_key());
        if let Some(origin) = origin {
            request = request.header("Origin", origin);
        }
        let stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream.set_nodelay(true).unwrap();
        stream
            .set_read_timeout(Some(Duration::from_secs(30)))
            .unwrap();
        match client(request.body(()).unwrap(), stream) {
            Ok((socket, _)) => {
                let mut page = Page {
                    socket,
                    hello: Value::Null,
                };
                page.hello = page.answer().0;
                Ok(page)
            }
            Err(tungstenite::HandshakeError::Failure(tungstenite::Error::Http(answer))) => {
                Err(answer.status().as_u16())
            }
            Err(other) => panic!("{other}"),
        }
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A page's end of a socket.
pub(crate) struct Page {
    pub(crate) socket: WebSocket<TcpStream>,
    pub(crate) hello: Value,
}

impl Page {
    pub(crate) fn send(&mut self, text: &str) {
        self.socket.send(Message::text(text)).unwrap();
    }

    /// The next answer: its head, and its picture.
    pub(crate) fn answer(&mut self) -> (Value, Vec<u8>) {
        let message = self.socket.read().unwrap().into_data();
        let (length, rest) = message.split_first_chunk().unwrap();
        let (head, body) = rest.split_at(u32::from_le_bytes(*length) as usize);
        (serde_json::from_slice(head).unwrap(), body.to_vec())
    }

    /// Asks for a picture with some fields of a question.
    pub(crate) fn ask(&mut self, fields: Value) -> (Value, Vec<u8>) {
        self.send(&question(fields).to_string());
        self.answer()
    }

    /// Reads on until the program closes the socket, and says why.
    pub(crate) fn closed(&mut self) -> Option<CloseCode> {
        loop {
            match self.socket.read() {
                Ok(Message::Close(frame)) => return frame.map(|frame| frame.code),
                Ok(_) => {}
                Err(_) => return None,
            }
        }
    }
}

/// A question with some fields of its own.
pub(crate) fn question(fields: Value) -> Value {
    let mut question =
        json!({ "seq": 1, "ask": "picture", "scene": 0, "size": [120, 90], "aa": 1 });
    question
        .as_object_mut()
        .unwrap()
        .extend(fields.as_object().unwrap().clone());
    question
}

/// Runs the program in the folder of the sources.
pub(crate) fn shiftvox(line: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_shiftvox"));
    command.args(line.split(' '));
    command.current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    command.output().unwrap()
}

/// Draws the picture of a printed command: its bytes, and its hash.
pub(crate) fn run_command(command: &str) -> (Vec<u8>, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture.png");
    let words = command.strip_prefix("shiftvox ").unwrap();
    let words = words.strip_suffix(" -o picture.png").unwrap();
    let output = shiftvox(&format!("{words} --hash -o {}", path.display()));
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command}: {told}");
    let hash = String::from_utf8(output.stdout).unwrap().trim().to_owned();
    (std::fs::read(path).unwrap(), hash)
}
