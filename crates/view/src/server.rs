//! The page and its sockets are for clients that know the token and name this computer by an address or as `localhost`
//! (against DNS rebinding). Sockets are for the page itself (Origin). A connection serves one request.

use std::collections::VecDeque;
use std::fs::{File, OpenOptions};
use std::io::{self, ErrorKind, Read, Write};
use std::net::{IpAddr, Ipv4Addr, Shutdown, SocketAddr, TcpListener, TcpStream};
#[cfg(unix)]
use std::os::unix::fs::{MetadataExt, OpenOptionsExt};
use std::path::Path;
use std::sync::{Arc, Mutex, Weak};
use std::thread;
use std::time::{Duration, Instant};

use tungstenite::error::{Error, ProtocolError};
use tungstenite::handshake::machine::TryParse;
use tungstenite::handshake::server::{Request, create_response, write_response};
use tungstenite::http::uri::Authority;
use tungstenite::http::{HeaderName, StatusCode, header};

use crate::{PAGE, Program, socket};

/// Most sockets; a page opens two.
const MOST_SOCKETS: usize = 8;
/// Most connections that are not sockets.
const MOST_CONNECTIONS: usize = 64;
/// Until the head of a request has arrived.
const HEAD_TIME: Duration = Duration::from_secs(3);
const MOST_HEAD: usize = 16 << 10;
/// Longest time of a write without progress; sockets make two attempts.
const WRITE_TIME: Duration = Duration::from_secs(5);

/// A server of the page.
#[derive(Debug)]
pub struct Server {
    listener: TcpListener,
    address: SocketAddr,
    token: String,
    /// One more reference for each socket.
    sockets: Arc<()>,
    /// Held while a file is taken, so that memory has only one.
    file: Mutex<()>,
}

impl Server {
    /// Listens on an address. Connections wait until [`Self::serve`] is called.
    ///
    /// # Errors
    /// The address cannot be used, or there are no random numbers.
    pub fn bind(address: SocketAddr) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        Ok(Self {
            address: listener.local_addr()?,
            listener,
            token: random_word()?,
            sockets: Arc::new(()),
            file: Mutex::new(()),
        })
    }

    /// Uses the token of a file that only its owner can read, or writes a new one there, for servers after a restart.
    ///
    /// # Errors
    /// The file cannot be used, others can read it, or it holds no token.
    pub fn keep_token(&mut self, file: &Path) -> io::Result<()> {
        let mut options = OpenOptions::new();
        options.write(true).create_new(true);
        #[cfg(unix)]
        options.mode(0o600);
        match options.open(file) {
            Ok(mut file) => return file.write_all(self.token.as_bytes()),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
        let file = File::open(file)?;
        #[cfg(unix)]
        if file.metadata()?.mode() & 0o077 != 0 {
            return Err(io::Error::other("other users can read it"));
        }
        let mut token = String::new();
        file.take(64).read_to_string(&mut token)?;
        let token = token.trim();
        if token.len() != 32 || !token.bytes().all(|digit| digit.is_ascii_hexdigit()) {
            return Err(io::Error::other(
                "it holds no token of 32 hexadecimal digits",
            ));
        }
        token.clone_into(&mut self.token);
        Ok(())
    }

    /// The page's address, with the token.
    #[must_use]
    pub fn page_address(&self) -> String {
        let mut address = self.address;
        // Clients cannot connect to "all addresses".
        if address.ip().is_unspecified() {
            address.set_ip(Ipv4Addr::LOCALHOST.into());
        }
        format!("http://{address}/?token={}", self.token)
    }

    /// Serves pages until the process ends.
    pub fn serve(&self, program: &impl Program) -> ! {
        // Connections that are not sockets, the oldest first.
        let mut open: VecDeque<Weak<TcpStream>> = VecDeque::new();
        thread::scope(|scope| {
            loop {
                let Ok((stream, _)) = self.listener.accept() else {
                    // For example too many open files.
                    thread::sleep(Duration::from_millis(100));
                    continue;
                };
                open.retain(|stream| stream.strong_count() > 0);
                while open.len() >= MOST_CONNECTIONS {
                    if let Some(oldest) = open[0].upgrade() {
                        let _ = oldest.shutdown(Shutdown::Both);
                    }
                    thread::sleep(Duration::from_millis(1));
                    open.retain(|stream| stream.strong_count() > 0);
                }
                let stream = Arc::new(stream);
                open.push_back(Arc::downgrade(&stream));
                let thread = thread::Builder::new().name("view".to_owned());
                // Without a thread the connection is closed.
                let _ = thread.spawn_scoped(scope, move || self.answer(stream, program));
            }
        })
    }

    fn answer(&self, stream: Arc<TcpStream>, program: &impl Program) {
        let _ = stream.set_nodelay(true);
        let _ = stream.set_write_timeout(Some(WRITE_TIME));
        let request = read_head(&stream);
        let (response, place) = request
            .and_then(|request| self.respond(&request))
            .unwrap_or_else(|(status, reason)| {
                let headers = "allow: GET\r\ncontent-type: text/plain; charset=utf-8\r\n";
                (response(status, headers, reason), None)
            });
        let sent = (&*stream).write_all(&response);
        let (Ok(()), Some((what, _place)), Some(stream)) = (sent, place, Arc::into_inner(stream))
        else {
            return;
        };
        match what {
            What::Page => socket::talk(stream, program),
            What::File => {
                let _one = self.file.lock();
                socket::take_file(stream, program);
            }
        }
    }

    /// The response, and the place of the socket that it opens.
    fn respond(&self, request: &Request) -> Result<(Vec<u8>, Option<Place>), Refused> {
        let what = match request.uri().path() {
            "/" => None,
            "/socket" => Some(What::Page),
            "/file" => Some(What::File),
            _ => return Err((StatusCode::NOT_FOUND, "there is no such page")),
        };
        let host = self.check(request)?;
        let Some(what) = what else {
            return Ok((page(host)?, None));
        };
        let origin = only(request, header::ORIGIN);
        if origin.and_then(|origin| origin.strip_prefix("http://")) != Some(host) {
            return Err((StatusCode::FORBIDDEN, "sockets are for the page itself"));
        }
        let mut head = Vec::new();
        create_response(request)
            .and_then(|accepted| write_response(&mut head, &accepted))
            .map_err(|_| (StatusCode::BAD_REQUEST, "this address is for WebSockets"))?;
        let place = Arc::clone(&self.sockets);
        if Arc::strong_count(&place) > 1 + MOST_SOCKETS {
            return Err((StatusCode::SERVICE_UNAVAILABLE, "too many pages are open"));
        }
        Ok((head, Some((what, place))))
    }

    /// Returns the name under which the page is requested.
    fn check<'r>(&self, request: &'r Request) -> Result<&'r str, Refused> {
        let name = only(request, header::HOST)
            .ok_or((StatusCode::BAD_REQUEST, "a request has one Host header"))?;
        let host = name.parse::<Authority>().ok();
        if !host.is_some_and(|host| is_own(host.host(), self.address.ip())) {
            let reason = "this page is not served under that name: open the printed address";
            return Err((StatusCode::FORBIDDEN, reason));
        }
        let mut query = request.uri().query().unwrap_or_default().split('&');
        let token = query.find_map(|pair| pair.strip_prefix("token="));
        if !token.is_some_and(|token| is_same(token, &self.token)) {
            let reason =
                "the token is missing or wrong: open the address that shiftvox view printed";
            return Err((StatusCode::FORBIDDEN, reason));
        }
        Ok(name)
    }
}

/// The use of a socket.
enum What {
    Page,
    File,
}

type Place = (What, Arc<()>);
type Refused = (StatusCode, &'static str);

fn read_head(mut stream: &TcpStream) -> Result<Request, Refused> {
    let late = |_| (StatusCode::REQUEST_TIMEOUT, "the request came too slowly");
    let until = Instant::now() + HEAD_TIME;
    let (mut head, mut part) = (Vec::new(), [0; 4096]);
    while head.len() < MOST_HEAD {
        let left = until.saturating_duration_since(Instant::now());
        stream.set_read_timeout(Some(left)).map_err(late)?;
        let count = stream.read(&mut part).map_err(late)?;
        head.extend_from_slice(&part[..count]);
        match Request::try_parse(&head) {
            Ok(Some((length, request))) if length == head.len() => return Ok(request),
            Ok(None) if count > 0 => {}
            Err(Error::Protocol(ProtocolError::WrongHttpMethod)) => {
                return Err((StatusCode::METHOD_NOT_ALLOWED, "requests are GET"));
            }
            _ => return Err((StatusCode::BAD_REQUEST, "this is not a request of HTTP/1.1")),
        }
    }
    let reason = "the head of the request is too long";
    Err((StatusCode::REQUEST_HEADER_FIELDS_TOO_LARGE, reason))
}

fn only(request: &Request, name: HeaderName) -> Option<&str> {
    let mut values = request.headers().get_all(name).iter();
    let value = values.next().filter(|_| values.next().is_none())?;
    value.to_str().ok()
}

/// No other site can use these names.
fn is_own(host: &str, bind: IpAddr) -> bool {
    let bare = host.strip_prefix('[').and_then(|h| h.strip_suffix(']'));
    match bare.unwrap_or(host).parse::<IpAddr>() {
        Ok(address) => address.is_loopback() || !bind.is_loopback(),
        Err(_) => host.eq_ignore_ascii_case("localhost"),
    }
}

/// Compares texts in a time that depends only on their lengths.
fn is_same(one: &str, other: &str) -> bool {
    let pairs = one.bytes().zip(other.bytes());
    let difference = pairs.fold(0, |all, (a, b)| std::hint::black_box(all | (a ^ b)));
    one.len() == other.len() && difference == 0
}

fn random_word() -> io::Result<String> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes)
        .map_err(|error| io::Error::other(format!("no random numbers: {error}")))?;
    Ok(format!("{:032x}", u128::from_ne_bytes(bytes)))
}

fn page(host: &str) -> Result<Vec<u8>, Refused> {
    let nonce =
        random_word().map_err(|_| (StatusCode::INTERNAL_SERVER_ERROR, "no random numbers"))?;
    let headers = format!(
        "content-type: text/html; charset=utf-8\r\n\
         content-security-policy: default-src 'none'; script-src 'nonce-{nonce}'; \
         style-src 'nonce-{nonce}'; connect-src 'self' ws://{host}; img-src data: blob:; \
         base-uri 'none'; form-action 'none'; frame-ancestors 'none'\r\n\
         x-content-type-options: nosniff\r\n\
         referrer-policy: no-referrer\r\n\
         cache-control: no-store\r\n\
         cross-origin-opener-policy: same-origin\r\n\
         cross-origin-resource-policy: same-origin\r\n"
    );
    let page = PAGE.replace("{{nonce}}", &nonce);
    Ok(response(StatusCode::OK, &headers, &page))
}

fn response(status: StatusCode, headers: &str, body: &str) -> Vec<u8> {
    let own = format!("content-length: {}\r\nconnection: close\r\n", body.len());
    format!("HTTP/1.1 {status}\r\n{headers}{own}\r\n{body}").into_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `tests/view/refusals.rs` of the program has the other names.
    #[test]
    fn other_addresses_are_own_where_all_are_served() {
        let (here, all) = ([127, 0, 0, 1].into(), [0, 0, 0, 0].into());
        let own = |host| [is_own(host, here), is_own(host, all)];
        assert_eq!(own("[::1]"), [true, true]);
        assert_eq!(own("192.168.0.7"), [false, true]);
        assert_eq!(own("localhost.evil.example"), [false, false]);
        assert!(is_same("abc", "abc"));
        assert!(
            ["", "ab", "abd", "abcd", "bbc"]
                .iter()
                .all(|wrong| !is_same(wrong, "abc"))
        );
    }
}
