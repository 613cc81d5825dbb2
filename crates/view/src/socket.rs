//! Requests do not queue: of those that have arrived, only the newest is answered. One that arrives during a drawing ends
//! it.

use std::io::{self, ErrorKind, Read, Write};
use std::net::TcpStream;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use serde_json::json;
use tungstenite::protocol::frame::Frame;
use tungstenite::protocol::frame::coding::{CloseCode, Data, OpCode};
use tungstenite::protocol::{CloseFrame, Role, WebSocketConfig};
use tungstenite::{Error, Message, Utf8Bytes, WebSocket};

use crate::request::MOST_FILE;
use crate::{Answer, Program, answer, hello, message};

/// Of a page.
const MOST_BYTES: usize = 4096;
/// Of a file's name, bytes.
const MOST_NAME: usize = 255;
/// Per second.
const MOST_MESSAGES: u32 = 250;
const SECOND: Duration = Duration::from_secs(1);
/// Until the drawer, whose buffers may take hundreds of megabytes, is dropped.
const IDLE: Duration = Duration::from_secs(10);

/// A stream for slow links. A write fails after two of the stream's time limits without progress.
struct Patient(TcpStream);

impl Read for Patient {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.0.read(bytes)
    }
}

impl Write for Patient {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // The system wakes a writer when a third of its buffer is free. A second attempt needs one byte.
        self.0.write(bytes).or_else(|_| self.0.write(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

pub(crate) fn talk(stream: TcpStream, program: &impl Program) {
    let config = WebSocketConfig::default()
        .read_buffer_size(MOST_BYTES)
        .max_message_size(Some(MOST_BYTES))
        .max_frame_size(Some(MOST_BYTES));
    let mut socket = WebSocket::from_raw_socket(Patient(stream), Role::Server, Some(config));
    // After an error nothing can be sent.
    if let Ok(closed) = answer_all(&mut socket, program) {
        let frame = closed.map(|(code, reason)| CloseFrame {
            code,
            reason: reason.into(),
        });
        let _ = socket.close(frame);
    }
}

/// Takes a dropped file: its name, then its bytes. The answer is the first message of a page, with one more scene.
pub(crate) fn take_file(stream: TcpStream, program: &impl Program) {
    let config = WebSocketConfig::default()
        .max_message_size(Some(MOST_FILE))
        .max_frame_size(Some(MOST_FILE));
    let mut socket = WebSocket::from_raw_socket(Patient(stream), Role::Server, Some(config));
    let read = |socket: &mut WebSocket<Patient>| {
        socket.get_ref().0.set_read_timeout(Some(IDLE))?;
        Ok::<_, Error>((socket.read()?, socket.read()?))
    };
    let opened = match read(&mut socket) {
        Ok((Message::Text(name), Message::Binary(bytes))) if name.len() <= MOST_NAME => {
            let open = || program.open(&name, &bytes);
            catch_unwind(AssertUnwindSafe(open)).unwrap_or(Err("it has a fault".to_owned()))
        }
        Ok(_) => Err("this is not a name and a file".to_owned()),
        Err(Error::Capacity(_)) => Err("the file is too large".to_owned()),
        Err(_) => return,
    };
    let head = match opened {
        Ok(()) => hello(program),
        Err(error) => json!({ "ask": "error", "error": error }),
    };
    if send(&mut socket, (head, Vec::new())).is_ok() {
        let _ = socket.close(None);
    }
}

/// Answers requests. Returns why this program closes the socket, or `None` if the page did.
fn answer_all(
    socket: &mut WebSocket<Patient>,
    program: &impl Program,
) -> Result<Option<(CloseCode, &'static str)>, Error> {
    let stream = Arc::new(socket.get_ref().0.try_clone()?);
    let was_stale = Arc::new(AtomicBool::new(false));
    send(socket, (hello(program), Vec::new()))?;
    socket.get_ref().0.set_read_timeout(Some(IDLE))?;
    let (mut drawer, mut newest) = (None, None::<Utf8Bytes>);
    let (mut second, mut count) = (Instant::now(), 0);
    loop {
        // After a request, only messages that have arrived are read.
        socket.get_ref().0.set_nonblocking(newest.is_some())?;
        let message = match socket.read() {
            Ok(message) => message,
            Err(Error::Io(error)) => {
                match error.kind() {
                    ErrorKind::WouldBlock | ErrorKind::TimedOut => {}
                    ErrorKind::Interrupted => continue,
                    _ => return Err(error.into()),
                }
                let Some(request) = newest.take() else {
                    drawer = None;
                    continue;
                };
                let drawer = drawer.get_or_insert_with(|| {
                    let (stream, was_stale) = (Arc::clone(&stream), Arc::clone(&was_stale));
                    // Something has arrived, or the page has gone. The stream does not block now.
                    program.drawer(move || {
                        let is_stale = stream.peek(&mut [0]).is_ok();
                        was_stale.fetch_or(is_stale, Ordering::Relaxed);
                        is_stale
                    })
                });
                let drawn = catch_unwind(AssertUnwindSafe(|| answer(drawer, &request)));
                let Ok(answer) = drawn else {
                    let reason = "the program cannot go on with this page";
                    return Ok(Some((CloseCode::Error, reason)));
                };
                if was_stale.swap(false, Ordering::Relaxed) {
                    // Drawn again unless what has arrived is a request.
                    newest = Some(request);
                    continue;
                }
                socket.get_ref().0.set_nonblocking(false)?;
                send(socket, answer)?;
                continue;
            }
            Err(Error::Capacity(_) | Error::Protocol(_) | Error::Utf8(_)) => {
                return Ok(Some((CloseCode::Size, "a message is too long or broken")));
            }
            Err(error) => return Err(error),
        };
        if second.elapsed() >= SECOND {
            (second, count) = (Instant::now(), 0);
        }
        count += 1;
        if count > MOST_MESSAGES {
            return Ok(Some((CloseCode::Policy, "too many messages")));
        }
        match message {
            Message::Text(text) => newest = Some(text),
            Message::Binary(_) => return Ok(Some((CloseCode::Unsupported, "messages are text"))),
            Message::Close(_) => return Ok(None),
            Message::Ping(_) | Message::Pong(_) | Message::Frame(_) => {}
        }
    }
}

fn send(socket: &mut WebSocket<Patient>, (head, picture): Answer) -> Result<(), Error> {
    let begin = message((head, Vec::new()));
    let begin = Frame::message(begin, OpCode::Data(Data::Binary), false);
    let rest = Frame::message(picture, OpCode::Data(Data::Continue), true);
    socket.write(Message::Frame(begin))?;
    socket.send(Message::Frame(rest))
}
