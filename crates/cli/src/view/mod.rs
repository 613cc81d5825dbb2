//! `view`: scenes on a page, for a browser on this computer.
//!
//! A page opens sockets, each of which has a thread that draws for it alone (`drawer.rs`). A
//! question on a socket has one answer, and where questions come faster than answers the newest
//! alone is answered: pictures never queue. What a page may ask is in `request.rs`, who may ask in
//! `server.rs`.

mod drawer;
mod overlay;
mod request;
mod server;

use std::net::{IpAddr, Ipv4Addr, SocketAddr, TcpListener};
use std::sync::{Arc, OnceLock};

use clap::Args;
use serde_json::json;

use super::args::{CameraArgs, EngineArgs, PictureArgs, SceneArgs};
use super::console::Console;
use super::error::{CliError, Kind};
use super::methods::{self, DrawArgs, Opened};
use super::{report, scenes};
use shiftvox::project::Coverage;

/// Arguments of `view`.
#[derive(Debug, Args)]
pub(super) struct ViewArgs {
    /// Scenes: files (also .far and .tvx), or generators such as gen:terrain,depth=10,seed=1
    #[arg(value_name = "SCENE", value_parser = crate::names::parser())]
    scenes: Vec<String>,
    /// Port to listen on; 0: one that is free
    #[arg(long, value_name = "N", default_value_t = 0)]
    port: u16,
    /// Address to listen on. With any other than this computer's own, everybody who knows the
    /// printed address can look, and nothing is encrypted: an SSH tunnel is better
    #[arg(long, value_name = "IP", default_value_t = IpAddr::V4(Ipv4Addr::LOCALHOST))]
    bind: IpAddr,
    #[command(flatten)]
    camera: CameraArgs,
    #[command(flatten)]
    picture: PictureArgs,
    #[command(flatten)]
    engine: EngineArgs,
    #[command(flatten)]
    scene: SceneArgs,
}

/// What all pages look at.
struct Shared {
    args: ViewArgs,
    scenes: Vec<Listed>,
    /// The secret of the printed address.
    token: String,
}

/// A scene of the list.
struct Listed {
    name: String,
    opened: Opened,
    /// A mesh with the opacities that `--coverage alpha` draws, once that was asked for.
    blended: Option<OnceLock<Result<Opened, CliError>>>,
}

impl Listed {
    fn open(name: &str, args: &ViewArgs, console: &Console) -> Result<Self, CliError> {
        let draw_args = args.draw_args(&args.engine, &args.picture);
        let opened = methods::open(name, &draw_args, console)?;
        drop(opened.drawable(&draw_args).map_err(|e| e.at(name))?);
        let is_blended = args.engine.rules.coverage.is_some_and(Coverage::blends);
        let reads_twice = !is_blended && !args.scene.opacities && scenes::is_mesh(name)?;
        Ok(Self {
            name: name.to_owned(),
            opened,
            blended: reads_twice.then(OnceLock::new),
        })
    }

    /// The scene as flags want it.
    fn for_flags(&self, args: &DrawArgs<'_>) -> Result<&Opened, CliError> {
        match &self.blended {
            Some(blended) if args.engine.rules.coverage.is_some_and(Coverage::blends) => blended
                .get_or_init(|| methods::open(&self.name, args, &Console::new(true, 0, false)))
                .as_ref()
                .map_err(Clone::clone),
            _ => Ok(&self.opened),
        }
    }
}

impl ViewArgs {
    fn draw_args<'a>(&'a self, engine: &'a EngineArgs, picture: &'a PictureArgs) -> DrawArgs<'a> {
        DrawArgs {
            engine,
            picture,
            scene: &self.scene,
            memory: None,
            is_hashed: false,
        }
    }
}

/// Serves pages until the program is stopped.
///
/// # Errors
/// A wrong command line, a bad scene, or an address that cannot be listened on.
pub(super) fn run(
    args: ViewArgs,
    from_config: Vec<String>,
    console: &Console,
) -> Result<(), CliError> {
    let names = scenes::choose(&args.scenes, from_config)?;
    args.camera.check().map_err(CliError::usage)?;
    if !args.picture.aov.is_empty() {
        return Err(CliError::usage(
            "--aov is for render; the page shows the same buffers as overlays",
        ));
    }
    request::check_first(&args.picture)?;
    let at = SocketAddr::new(args.bind, args.port);
    let listener = listen(at)?;
    let token = random_word()?;
    let opened = names.iter().map(|name| Listed::open(name, &args, console));
    let scenes = opened.collect::<Result<Vec<_>, _>>()?;
    let bound = listener.local_addr().map_err(|e| failed(&e))?;
    // All addresses are no address: others put this computer's name before the port.
    let shown = match bound.ip() {
        ip if ip.is_unspecified() => SocketAddr::new(Ipv4Addr::LOCALHOST.into(), bound.port()),
        _ => bound,
    };
    let address = format!("http://{shown}/?token={token}");
    match console.json {
        true => console.line(&report::document("view", json!({ "address": address })).to_string()),
        false => console.data(&address),
    }?;
    console.note("open this address in a browser; Ctrl-C ends the program");
    if !bound.ip().is_loopback() {
        let mut note =
            "who knows the token can look from other computers, and nothing is encrypted";
        if bound.ip().is_unspecified() {
            note = "who knows the token can look from other computers, under this one's address, and nothing is encrypted";
        }
        console.note(note);
    }
    let shared = Arc::new(Shared {
        args,
        scenes,
        token,
    });
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build();
    let runtime = runtime.map_err(|e| failed(&e))?;
    runtime
        .block_on(server::serve(listener, shared))
        .map_err(|e| failed(&e))
}

fn failed(error: &std::io::Error) -> CliError {
    CliError::new(Kind::Run, format!("cannot serve the page: {error}"))
}

fn listen(at: SocketAddr) -> Result<TcpListener, CliError> {
    let listen = || {
        let listener = TcpListener::bind(at)?;
        listener.set_nonblocking(true)?;
        Ok(listener)
    };
    listen().map_err(|error: std::io::Error| {
        let advice = match error.kind() {
            std::io::ErrorKind::AddrNotAvailable => "--bind takes an address of this computer",
            _ => "leave --port out: a free one is found",
        };
        CliError::new(Kind::Run, format!("cannot listen on {at}: {error}")).advise(advice)
    })
}

/// 128 random bits, as 32 hexadecimal digits.
fn random_word() -> Result<String, CliError> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes)
        .map_err(|error| CliError::new(Kind::Run, format!("no random numbers: {error}")))?;
    Ok(format!("{:032x}", u128::from_ne_bytes(bytes)))
}
