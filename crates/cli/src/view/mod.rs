//! `view`: scenes on a page, for a browser on this computer.

mod drawer;
mod flags;
mod overlay;

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::sync::OnceLock;

use clap::{ArgMatches, Args};
use serde_json::json;
use shiftvox::project::{Coverage, Stop};
use shiftvox_view::{Flags, Server};

use super::args::{CameraArgs, EngineArgs, PictureArgs, SceneArgs};
use super::console::Console;
use super::error::{CliError, Kind};
use super::methods::{self, DrawArgs, Opened};
use super::{document, scenes};

#[derive(Debug, Args)]
pub(super) struct ViewArgs {
    /// Scenes: files (also .far and .tvx), or generators such as gen:terrain,depth=10,seed=1
    #[arg(value_name = "SCENE", required = true)]
    scenes: Vec<String>,
    /// Port to listen on, 0 for any free one
    #[arg(long, value_name = "N", default_value_t = 0)]
    port: u16,
    /// Address to listen on. From other computers an SSH tunnel is better: nothing is encrypted, and
    /// everybody who knows the printed address can look
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

struct Shared {
    args: ViewArgs,
    /// The flags with which pages begin.
    first: Flags,
    /// The flags with which scenes were read.
    scene_words: Vec<String>,
    scenes: Vec<Listed>,
}

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
        drop(
            opened
                .drawable(&draw_args, &Stop::default())
                .map_err(|e| e.at(name))?,
        );
        let is_blended = args.engine.rules.coverage.is_some_and(Coverage::blends);
        let reads_twice = !is_blended && !args.scene.opacities && scenes::is_mesh(name)?;
        Ok(Self {
            name: name.to_owned(),
            opened,
            blended: reads_twice.then(OnceLock::new),
        })
    }

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

pub(super) fn run(args: ViewArgs, matches: &ArgMatches, console: &Console) -> Result<(), CliError> {
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
    let opened = args.scenes.iter();
    let opened = opened.map(|name| Listed::open(name, &args, console));
    let scenes = opened.collect::<Result<Vec<_>, _>>()?;
    let address = server.page_address();
    match console.json {
        true => {
            console.line(&document::document("view", json!({ "address": address })).to_string())
        }
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
    let matches = matches.subcommand().map_or(matches, |(_, of_view)| of_view);
    server.serve(&Shared {
        first: flags::first(matches),
        scene_words: flags::scene_words(matches),
        args,
        scenes,
    })
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
