//! `view`: scenes on a page, for a browser on this computer.

mod drawer;
mod flags;
mod overlay;

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::ops::Deref;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::{Arc, Mutex, OnceLock, PoisonError, RwLock};
use std::{io, thread};

use clap::{ArgMatches, Args};
use serde_json::json;
use shiftvox::graph::Crop;
use shiftvox::project::{Bounds, Coverage, Stop};
use shiftvox_view::{Flags, Server};

use super::console::Console;
use super::error::{CliError, Kind};
use super::methods::{self, DrawArgs, DrawFlags, Opened};
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
    /// Keep the token of the address in this file, so that open pages continue after a restart on the same --port
    #[arg(long, value_name = "FILE")]
    token_file: Option<PathBuf>,
    /// Open the page in a browser: that of the variable BROWSER, or this computer's. Other users of this computer
    /// may see the address among its processes
    #[arg(long)]
    open: bool,
    #[command(flatten)]
    flags: DrawFlags,
}

struct Shared {
    args: ViewArgs,
    /// The flags with which pages begin.
    first: Flags,
    /// The flags with which scenes were read.
    scene_words: Vec<String>,
    /// Those of dropped files are last. They stay until the program ends, so drawings borrow them.
    scenes: RwLock<Vec<&'static Listed>>,
}

/// Dropped files until the program ends.
const MOST_DROPPED: usize = 16;

struct Listed {
    name: String,
    opened: Opened,
    /// A mesh with the opacities that `--coverage alpha` draws, after the first request for them.
    blended: Option<OnceLock<Result<Opened, CliError>>>,
    /// The last part of it that a page has asked for.
    part: Mutex<Option<(Crop, Arc<Opened>)>>,
    extent: OnceLock<Option<[[i64; 3]; 2]>>,
}

/// A scene, or the part of one within a box.
enum Chosen {
    Whole(&'static Opened),
    Part(Arc<Opened>),
}

impl Deref for Chosen {
    type Target = Opened;

    fn deref(&self) -> &Opened {
        match self {
            Self::Whole(opened) => opened,
            Self::Part(opened) => opened,
        }
    }
}

impl Listed {
    fn open(name: &str, args: &ViewArgs, console: &Console) -> Result<Self, CliError> {
        let draw_args = args.flags.draw_args(None, false);
        let opened = methods::open(name, &draw_args, console)?;
        let drawable = opened.drawable(&draw_args, &Stop::default());
        drawable.map(drop).map_err(|e| e.at(name))?;
        let coverage = args.flags.engine.rules.coverage;
        let is_blended = coverage.is_some_and(Coverage::blends);
        let reads_twice = !is_blended && !args.flags.scene.opacities && scenes::is_mesh(name)?;
        Ok(Self {
            name: name.to_owned(),
            opened,
            blended: reads_twice.then(OnceLock::new),
            part: Mutex::default(),
            extent: OnceLock::new(),
        })
    }

    fn dropped(name: &str, bytes: &[u8], args: &ViewArgs) -> Result<Self, CliError> {
        let draw_args = args.flags.draw_args(None, false);
        Ok(Self {
            name: name.to_owned(),
            opened: methods::open_bytes(name, bytes, &draw_args)?,
            blended: None,
            part: Mutex::default(),
            extent: OnceLock::new(),
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

    /// The whole scene, or the part that a request draws.
    fn chosen(&'static self, args: &DrawArgs<'_>, crop: Option<&Crop>) -> Result<Chosen, CliError> {
        let whole = self.for_flags(args)?;
        let Some(crop) = crop else {
            return Ok(Chosen::Whole(whole));
        };
        let mut kept = self.part.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((of, part)) = &*kept
            && of == crop
            && std::ptr::eq(whole, &raw const self.opened)
        {
            return Ok(Chosen::Part(Arc::clone(part)));
        }
        let part = Arc::new(whole.cropped(&self.name, crop)?);
        *kept = Some((crop.clone(), Arc::clone(&part)));
        Ok(Chosen::Part(part))
    }

    /// The least and the greatest index of its voxels in the file, plus one.
    fn extent(&self) -> Option<[[i64; 3]; 2]> {
        let find = || self.opened.graph().and_then(Bounds::in_file);
        *self.extent.get_or_init(find)
    }
}

pub(super) fn run(
    mut args: ViewArgs,
    matches: &ArgMatches,
    console: &Console,
) -> Result<(), CliError> {
    args.flags.camera.check().map_err(CliError::usage)?;
    // Scenes are whole: a page crops them.
    args.flags.scene.crop = None;
    if !args.flags.picture.aov.is_empty() {
        return Err(CliError::usage(
            "--aov is for render; the page shows the same buffers as overlays",
        ));
    }
    if let Some(size) = args.flags.picture.size {
        let size = [size.width, size.height];
        shiftvox_view::check_size(size, 1 << args.flags.picture.aa_log2())
            .map_err(|reason| CliError::new(Kind::Limit, reason))?;
    }
    let mut server = listen(SocketAddr::new(args.bind, args.port))?;
    if let Some(file) = &args.token_file {
        let kept = server.keep_token(file);
        kept.map_err(|error| CliError::input(format!("{}: {error}", file.display())))?;
    }
    let opened = args.scenes.iter();
    let opened = opened.map(|name| Listed::open(name, &args, console));
    let opened = opened.map(|scene| Ok(&*Box::leak(Box::new(scene?))));
    let scenes = opened.collect::<Result<Vec<_>, CliError>>()?;
    let address = server.page_address();
    match console.json {
        true => {
            console.line(&document::document("view", json!({ "address": address })).to_string())
        }
        false => console.data(&address),
    }?;
    match args.open.then(|| open_browser(&address)) {
        Some(Ok(())) => console.note("Ctrl-C ends the program"),
        Some(Err(error)) => console.note(format!(
            "no browser has started ({error}): open this address"
        )),
        None => console.note("open this address in a browser; Ctrl-C ends the program"),
    }
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
        scenes: RwLock::new(scenes),
        args,
    })
}

fn open_browser(address: &str) -> io::Result<()> {
    let own = match std::env::consts::OS {
        "macos" => "open",
        "windows" => "explorer",
        _ => "xdg-open",
    };
    let program = std::env::var_os("BROWSER").unwrap_or_else(|| own.into());
    let mut command = Command::new(program);
    let quiet = command
        .arg(address)
        .stdin(Stdio::null())
        .stdout(Stdio::null());
    let mut child = quiet.stderr(Stdio::null()).spawn()?;
    thread::spawn(move || child.wait());
    Ok(())
}

fn listen(at: SocketAddr) -> Result<Server, CliError> {
    Server::bind(at).map_err(|error| {
        let advice = match error.kind() {
            io::ErrorKind::AddrNotAvailable => "--bind takes an address of this computer",
            _ => "leave --port out: a free one is found",
        };
        CliError::new(Kind::Run, format!("cannot listen on {at}: {error}")).advise(advice)
    })
}
