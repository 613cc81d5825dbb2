//! `view`: scenes on a page, for a browser on this computer.
//!
//! The crate `shiftvox-view` serves the page. `drawer.rs` answers its requests, with the settings
//! that `flags.rs` parses and the overlays of `overlay.rs`.

mod drawer;
mod flags;
mod overlay;

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::sync::OnceLock;

use clap::Args;
use serde_json::json;
use shiftvox::project::Coverage;
use shiftvox_view::Server;

use super::args::{CameraArgs, EngineArgs, PictureArgs, SceneArgs};
use super::console::Console;
use super::error::{CliError, Kind};
use super::methods::{self, DrawArgs, Opened};
use super::{report, scenes};

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

/// The scenes and the settings of all pages.
struct Shared {
    args: ViewArgs,
    scenes: Vec<Listed>,
}

/// A scene of the list.
struct Listed {
    name: String,
    opened: Opened,
    /// A mesh with the opacities that `--coverage alpha` draws, after the first request for them.
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

    /// The scene that is drawn with these flags.
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
/// A wrong command line, a bad scene, or an address that cannot be used.
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
    if let Some(size) = args.picture.size {
        let size = [size.width, size.height];
        shiftvox_view::check_size(size, 1 << args.picture.aa_log2())
            .map_err(|reason| CliError::new(Kind::Limit, reason))?;
    }
    let server = listen(SocketAddr::new(args.bind, args.port))?;
    let opened = names.iter().map(|name| Listed::open(name, &args, console));
    let scenes = opened.collect::<Result<Vec<_>, _>>()?;
    let address = server.page_address();
    match console.json {
        true => console.line(&report::document("view", json!({ "address": address })).to_string()),
        false => console.data(&address),
    }?;
    console.note("open this address in a browser; Ctrl-C ends the program");
    if !args.bind.is_loopback() {
        let under = match args.bind.is_unspecified() {
            true => ", under this one's address,",
            false => ",",
        };
        console.note(format!(
            "who knows the token can look from other computers{under} and nothing is encrypted"
        ));
    }
    server.serve(&Shared { args, scenes })
}

fn listen(at: SocketAddr) -> Result<Server, CliError> {
    Server::bind(at).map_err(|error| {
        let advice = match error.kind() {
            std::io::ErrorKind::AddrNotAvailable => "--bind takes an address of this computer",
            _ => "leave --port out: a free one is found",
        };
        CliError::new(Kind::Run, format!("cannot listen on {at}: {error}")).advise(advice)
    })
}
