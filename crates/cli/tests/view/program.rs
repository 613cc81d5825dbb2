//! The program under test, and a page's end of its sockets.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

use serde_json::{Value, json};
use tungstenite::client::ClientRequestBuilder;
use tungstenite::protocol::frame::coding::CloseCode;
use tungstenite::{Message, WebSocket};

/// A program that serves pages, until it goes out of scope.
pub(crate) struct Program {
    pub(crate) child: Child,
    pub(crate) address: String,
    pub(crate) host: String,
    pub(crate) token: String,
}

/// `shiftvox` with these words, in the folder of the sources.
pub(crate) fn command(line: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_shiftvox"));
    command.args(line.split(' '));
    command.current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    command
}

impl Program {
    /// Starts `shiftvox view` with these words.
    pub(crate) fn start(line: &str) -> Self {
        let mut command = command(&format!("view --quiet {line}"));
        let mut child = command.stdout(Stdio::piped()).spawn().unwrap();
        let mut address = String::new();
        let stdout = child.stdout.take().unwrap();
        BufReader::new(stdout).read_line(&mut address).unwrap();
        let address = address.trim().to_owned();
        let parts = address.strip_prefix("http://").unwrap();
        let (host, token) = parts.split_once("/?token=").unwrap();
        Self {
            child,
            host: host.to_owned(),
            token: token.to_owned(),
            address,
        }
    }

    pub(crate) fn stream(&self) -> TcpStream {
        let stream = TcpStream::connect(&self.host).unwrap();
        let patience = Some(Duration::from_secs(30));
        stream.set_read_timeout(patience).unwrap();
        stream
    }

    /// Sends a request: its first line up to the version, and headers, separated by `|`. Returns the answer, or of a
    /// socket that opens the first line.
    pub(crate) fn request(&self, parts: &str) -> String {
        let mut parts = parts.split('|').map(str::trim);
        let mut head = format!("{} HTTP/1.1\r\n", parts.next().unwrap());
        head.extend(parts.map(|header| format!("{header}\r\n")));
        let mut stream = self.stream();
        stream.write_all(format!("{head}\r\n").as_bytes()).unwrap();
        let mut stream = BufReader::new(stream);
        let mut answer = String::new();
        let _ = stream.read_line(&mut answer);
        if !answer.starts_with("HTTP/1.1 101") {
            let _ = stream.read_to_string(&mut answer);
        }
        answer
    }

    /// Opens a socket as the page does, if there is a place for it.
    pub(crate) fn socket(&self, path: &str) -> Option<Page> {
        let Self { host, token, .. } = self;
        let uri = format!("ws://{host}/{path}?token={token}").parse().unwrap();
        let request =
            ClientRequestBuilder::new(uri).with_header("Origin", format!("http://{host}"));
        let (socket, _) = tungstenite::client(request, self.stream()).ok()?;
        let hello = Value::Null;
        Some(Page { socket, hello })
    }

    pub(crate) fn try_page(&self) -> Option<Page> {
        let mut page = self.socket("socket")?;
        page.hello = page.answer().0;
        Some(page)
    }

    pub(crate) fn page(&self) -> Page {
        self.try_page().unwrap()
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
    pub(crate) fn send(&mut self, text: impl ToString) {
        self.socket.send(Message::text(text.to_string())).unwrap();
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
        self.send(question(fields));
        self.answer()
    }

    /// Reads until the program closes the socket, and returns the reason.
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
pub(crate) fn question(mut fields: Value) -> Value {
    let question = json!({ "seq": 1, "ask": "picture", "scene": 0, "size": [120, 90], "aa": 1 });
    for (key, value) in question.as_object().unwrap() {
        if fields[key].is_null() {
            fields[key] = value.clone();
        }
    }
    fields
}

pub(crate) fn shiftvox(line: &str) -> Output {
    command(line).output().unwrap()
}

/// The index and level of the voxel that a pixel of a printed command's picture shows, by `--aov voxel`.
pub(crate) fn voxel_of(command: &str, [x, y]: [usize; 2], width: usize) -> [i32; 4] {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture.png");
    let words = command.strip_prefix("shiftvox ").unwrap();
    let words = words.strip_suffix(" -o picture.png --force").unwrap();
    let output = shiftvox(&format!("{words} --aov voxel -o {}", path.display()));
    assert!(output.status.success(), "{command}");
    let array = std::fs::read(path.with_extension("voxel.npy")).unwrap();
    // The array follows the line of its head.
    let begin = array.iter().position(|&byte| byte == b'\n').unwrap() + 1;
    let pixel: [u8; 16] = *array[begin..].as_chunks().0.get(y * width + x).unwrap();
    std::array::from_fn(|k| i32::from_le_bytes(pixel.as_chunks().0[k]))
}

/// Draws the picture of a printed command: its bytes, and its hash.
pub(crate) fn run_command(command: &str) -> (Vec<u8>, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture.png");
    let words = command.strip_prefix("shiftvox ").unwrap();
    let words = words.strip_suffix(" -o picture.png --force").unwrap();
    let output = shiftvox(&format!("{words} --hash -o {}", path.display()));
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command}: {told}");
    let hash = String::from_utf8(output.stdout).unwrap().trim().to_owned();
    (std::fs::read(path).unwrap(), hash)
}
