//! Who may ask: connections, and the checks of their requests.
//!
//! A page is given to whoever knows the token, asked for by an address or as `localhost`: a name
//! would let another site's page reach it (DNS rebinding). A socket is opened for that page alone
//! (Origin). Sizes, rates, times and numbers have limits.

use std::io;
use std::net::IpAddr;
use std::pin::pin;
use std::sync::Arc;
use std::sync::mpsc;
use std::time::{Duration, Instant};

use axum::Router;
use axum::body::Bytes;
use axum::extract::State;
use axum::extract::ws::{CloseFrame, Message, WebSocket, WebSocketUpgrade};
use axum::http::uri::{Authority, Uri};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use futures_util::future::{Either, select};
use futures_util::{SinkExt, StreamExt};
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::timeout;
use tokio_io_timeout::TimeoutStream;

use super::{Shared, drawer, random_word};

/// The page, all of it.
const PAGE: &str = include_str!("page.html");
/// Most sockets; a page opens two.
const MOST_SOCKETS: usize = 8;
/// Most connections that are not sockets.
const MOST_CONNECTIONS: usize = 64;
/// Most bytes of a message from a page.
const MOST_BYTES: usize = 4096;
/// Most messages in a second.
const MOST_MESSAGES: u32 = 250;
/// For how long a request's head may come, and nothing of an answer may go.
const PATIENCE: Duration = Duration::from_secs(10);
/// For how long a connection may last that is not a socket's.
const LONGEST: Duration = Duration::from_secs(20);

/// What the server knows.
#[derive(Clone)]
struct Served {
    shared: Arc<Shared>,
    sockets: Arc<Semaphore>,
}

/// Serves pages for ever.
///
/// # Errors
/// When the system's events cannot be had.
pub(super) async fn serve(listener: std::net::TcpListener, shared: Arc<Shared>) -> io::Result<()> {
    let listener = tokio::net::TcpListener::from_std(listener)?;
    let served = Served {
        shared,
        sockets: Arc::new(Semaphore::new(MOST_SOCKETS)),
    };
    let app = Router::new()
        .route("/", get(page))
        .route("/socket", get(socket))
        .with_state(served);
    let connections = Arc::new(Semaphore::new(MOST_CONNECTIONS));
    loop {
        let place = Arc::clone(&connections).acquire_owned().await;
        let Ok((stream, _)) = listener.accept().await else {
            // Too many open files, and the like: it passes.
            tokio::time::sleep(Duration::from_millis(100)).await;
            continue;
        };
        // Answers are waited for.
        let _ = stream.set_nodelay(true);
        // A slow link gets large pictures too, as long as some of them goes.
        let mut stream = TimeoutStream::new(stream);
        stream.set_write_timeout(Some(PATIENCE));
        let service = TowerToHyperService::new(app.clone());
        tokio::spawn(async move {
            let _place = place;
            let connection = http1::Builder::new()
                .timer(TokioTimer::new())
                .header_read_timeout(PATIENCE)
                .max_buf_size(16 << 10)
                .serve_connection(TokioIo::new(Box::pin(stream)), service);
            // What a client does wrong is its own affair. A socket goes on without this.
            let _ = timeout(LONGEST, connection.with_upgrades()).await;
        });
    }
}

/// A request that is refused, and why.
type Refused = (StatusCode, &'static str);

/// Checks the name that the page was asked for by, and the token. Returns the name.
fn admit<'h>(shared: &Shared, headers: &'h HeaderMap, uri: &Uri) -> Result<&'h str, Refused> {
    let name = only(headers, header::HOST).ok_or((StatusCode::BAD_REQUEST, "one Host, please"))?;
    let host = name.parse::<Authority>().ok();
    if !host.is_some_and(|host| is_own(host.host(), shared.args.bind)) {
        let reason = "this page is not served under that name: open the printed address";
        return Err((StatusCode::FORBIDDEN, reason));
    }
    let query = uri.query().unwrap_or_default();
    let token = query
        .split('&')
        .find_map(|pair| pair.strip_prefix("token="));
    if !token.is_some_and(|token| is_same(token, &shared.token)) {
        let reason = "the token is missing or wrong: open the address that shiftvox view printed";
        return Err((StatusCode::FORBIDDEN, reason));
    }
    Ok(name)
}

/// A header that is there once.
fn only(headers: &HeaderMap, name: header::HeaderName) -> Option<&str> {
    let mut values = headers.get_all(name).iter();
    let value = values.next().filter(|_| values.next().is_none())?;
    value.to_str().ok()
}

/// Whether a host is this computer by its address, or `localhost`: no name that others can point
/// here. Pages for this computer alone are asked for by its own addresses.
fn is_own(host: &str, bind: IpAddr) -> bool {
    let bare = host.strip_prefix('[').and_then(|h| h.strip_suffix(']'));
    match bare.unwrap_or(host).parse::<IpAddr>() {
        Ok(address) => address.is_loopback() || !bind.is_loopback(),
        Err(_) => host.eq_ignore_ascii_case("localhost"),
    }
}

/// Whether two texts are the same, in a time that depends on their lengths alone.
fn is_same(one: &str, other: &str) -> bool {
    let pairs = one.bytes().zip(other.bytes());
    let difference = pairs.fold(0, |all, (a, b)| std::hint::black_box(all | (a ^ b)));
    one.len() == other.len() && difference == 0
}

/// Gives the page.
async fn page(State(served): State<Served>, headers: HeaderMap, uri: Uri) -> Response {
    let name = match admit(&served.shared, &headers, &uri) {
        Ok(name) => name,
        Err(refused) => return refused.into_response(),
    };
    let Ok(nonce) = random_word() else {
        return StatusCode::INTERNAL_SERVER_ERROR.into_response();
    };
    let policy = format!(
        "default-src 'none'; script-src 'nonce-{nonce}'; style-src 'nonce-{nonce}'; \
         connect-src ws://{name}; img-src data: blob:; base-uri 'none'; form-action 'none'; \
         frame-ancestors 'none'"
    );
    let headers = [
        (header::CONTENT_TYPE, "text/html; charset=utf-8"),
        (header::CONTENT_SECURITY_POLICY, &policy),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::CACHE_CONTROL, "no-store"),
    ];
    let isolated = [
        ("cross-origin-opener-policy", "same-origin"),
        ("cross-origin-resource-policy", "same-origin"),
    ];
    let page = PAGE.replace("{{nonce}}", &nonce);
    (headers, isolated, page).into_response()
}

/// Opens a socket.
async fn socket(
    State(served): State<Served>,
    headers: HeaderMap,
    uri: Uri,
    upgrade: Result<WebSocketUpgrade, axum::extract::ws::rejection::WebSocketUpgradeRejection>,
) -> Response {
    let name = match admit(&served.shared, &headers, &uri) {
        Ok(name) => name,
        Err(refused) => return refused.into_response(),
    };
    let origin = only(&headers, header::ORIGIN);
    if origin.and_then(|origin| origin.strip_prefix("http://")) != Some(name) {
        return (StatusCode::FORBIDDEN, "sockets are for the page itself").into_response();
    }
    let upgrade = match upgrade {
        Ok(upgrade) => upgrade,
        Err(refused) => return refused.into_response(),
    };
    let Ok(place) = served.sockets.try_acquire_owned() else {
        return (StatusCode::SERVICE_UNAVAILABLE, "too many pages are open").into_response();
    };
    upgrade
        .max_message_size(MOST_BYTES)
        .max_frame_size(MOST_BYTES)
        .on_upgrade(|socket| talk(socket, served.shared, place))
}

/// Why a socket is closed from this side.
struct Closed(u16, &'static str);

/// Hands questions to a thread that draws, and its answers back.
async fn talk(socket: WebSocket, shared: Arc<Shared>, place: OwnedSemaphorePermit) {
    let (ask, questions) = mpsc::sync_channel(MOST_MESSAGES as usize);
    let (answer, mut answers) = tokio::sync::mpsc::channel::<Bytes>(1);
    let thread = std::thread::Builder::new().name("view".to_owned());
    let draws = thread.spawn(move || {
        // A socket's place is free when its last picture is drawn.
        let _place = place;
        drawer::run(&shared, &questions, &answer);
    });
    let (mut sink, mut stream) = socket.split();
    let mut closed = None;
    if draws.is_ok() {
        let reading = pin!(async {
            let mut rate = Rate::default();
            while let Some(message) = stream.next().await {
                let Ok(message) = message else {
                    return Some(Closed(1009, "a message is too long or broken"));
                };
                if !rate.admits(Instant::now()) {
                    return Some(Closed(1008, "too many messages"));
                }
                match message {
                    Message::Text(text) => match ask.try_send(text.as_str().to_owned()) {
                        Ok(()) => {}
                        Err(_) => return Some(Closed(1008, "too many messages wait")),
                    },
                    Message::Binary(_) => return Some(Closed(1003, "messages are text")),
                    Message::Ping(_) | Message::Pong(_) => {}
                    Message::Close(_) => break,
                }
            }
            None
        });
        let writing = pin!(async {
            while let Some(answer) = answers.recv().await {
                if sink.send(Message::Binary(answer)).await.is_err() {
                    return;
                }
            }
        });
        closed = match select(reading, writing).await {
            Either::Left((closed, _)) => closed,
            Either::Right(_) => Some(Closed(1011, "the program cannot go on with this page")),
        };
    }
    if let Some(Closed(code, reason)) = closed {
        let frame = CloseFrame {
            code,
            reason: reason.into(),
        };
        let last = sink.send(Message::Close(Some(frame)));
        let _ = timeout(Duration::from_secs(1), last).await;
    }
}

/// Counts messages, second by second.
#[derive(Default)]
struct Rate {
    since: Option<Instant>,
    count: u32,
}

impl Rate {
    fn admits(&mut self, now: Instant) -> bool {
        let since = *self.since.get_or_insert(now);
        if now.duration_since(since) >= Duration::from_secs(1) {
            (self.since, self.count) = (Some(now), 0);
        }
        self.count += 1;
        self.count <= MOST_MESSAGES
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn this_computer_is_asked_for_by_address() {
        let (here, all) = ([127, 0, 0, 1].into(), [0, 0, 0, 0].into());
        for own in ["127.0.0.1", "localhost", "LOCALHOST", "[::1]", "127.1.2.3"] {
            assert!(is_own(own, here) && is_own(own, all), "{own}");
        }
        assert!(is_own("192.168.0.7", all) && !is_own("192.168.0.7", here));
        for other in [
            "evil.example",
            "localhost.evil.example",
            "",
            "127.0.0.1.nip.io",
        ] {
            assert!(!is_own(other, here) && !is_own(other, all), "{other}");
        }
    }

    #[test]
    fn tokens_are_compared_to_the_last_letter() {
        assert!(is_same("abc", "abc"));
        for wrong in ["", "ab", "abd", "abcd", "bbc"] {
            assert!(!is_same(wrong, "abc"), "{wrong}");
        }
    }

    #[test]
    fn messages_have_a_rate() {
        let (mut rate, start) = (Rate::default(), Instant::now());
        assert!((0..MOST_MESSAGES).all(|_| rate.admits(start)));
        assert!(!rate.admits(start));
        assert!(rate.admits(start + Duration::from_secs(1)));
    }
}
