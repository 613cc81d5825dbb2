//! Draws what a page asks for, by the library.

use std::sync::{Arc, Mutex, PoisonError};

use glam::DVec3;
use serde_json::{Value, json};
use shiftvox::graph::Crop;
use shiftvox::project::{Bounds, Camera as Placed};
use shiftvox::scene::BUNDLED_TREE;
use shiftvox::{
    Buffer, CageKind, Camera, Coverage, EngineKind, Picture, Renderer, Scene, Shading, View,
};
use shiftvox_view::{Answer, Ask, FLAGS, Program, Request, command, picked};

#[derive(Debug)]
pub(super) struct Opened {
    name: String,
    scene: Scene,
    extent: Option<[[i64; 3]; 2]>,
    /// The last part of it that the page has asked for.
    part: Mutex<Option<(String, Arc<Scene>)>>,
}

impl Opened {
    pub(super) fn of(name: &str, bytes: &[u8]) -> Result<Self, String> {
        let (name, file, bytes) = match name {
            "" => ("assets/tree.vox", "tree.vox", BUNDLED_TREE),
            name => (name, name, bytes),
        };
        let scene = Scene::from_bytes(bytes, file).map_err(|error| error.to_string())?;
        Ok(Self {
            extent: Bounds::in_file(scene.graph()),
            part: Mutex::default(),
            name: name.to_owned(),
            scene,
        })
    }

    /// The part within the request's box.
    fn part(&self, request: &Request) -> Result<Option<Arc<Scene>>, String> {
        let Some(text) = request.flags.get("crop") else {
            return Ok(None);
        };
        let mut kept = self.part.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, part)) = kept.as_ref().filter(|(of, _)| of == text) {
            return Ok(Some(Arc::clone(part)));
        }
        let crop: Crop = text.parse()?;
        let part = self
            .scene
            .cropped(crop.0)
            .map_err(|error| error.to_string())?;
        let part = Arc::new(part);
        *kept = Some((text.clone(), Arc::clone(&part)));
        Ok(Some(part))
    }

    fn picture(&self, request: &Request) -> Result<Answer, String> {
        let started = now();
        if request.show.as_ref().is_some_and(|show| show != "color") {
            return Err(
                "a page without a server shows colours only: use `shiftvox view`".to_owned(),
            );
        }
        let [width, height] = request.size;
        let (camera, picture) = self.draw(request, &[Buffer::Node])?;
        let drawn_ms = now() - started;
        let nodes = picture.nodes().map_err(|error| error.to_string())?;
        let hash = request
            .hash
            .then(|| picture.hash().map(str::to_owned))
            .transpose();
        let aa = (request.aa != 1).then(|| format!("--aa={}", request.aa));
        let words = request.words(FLAGS).chain(aa);
        let command = command("render", &self.name, words, request.size, &camera.flags());
        let head = json!({
            "width": width,
            "height": height,
            "png": false,
            "camera": camera,
            "axis": self.scene.up().axis().to_array(),
            "extent": self.extent,
            "engine": request.flags.get("engine").map_or("fast", String::as_str),
            "command": command + " -o picture.png --force",
            "hash": hash.map_err(|error| error.to_string())?,
            "counters": picture.counters(),
            "pixels_drawn": nodes.iter().filter(|&&node| node >= 0).count(),
            "draw_ms": drawn_ms,
        });
        Ok((head, picture.rgba().as_flattened().to_vec()))
    }

    fn draw(&self, request: &Request, buffers: &[Buffer]) -> Result<(Placed, Picture), String> {
        let [width, height] = request.size;
        let camera = self.camera(request)?;
        let renderer = settings(request)?.buffers(buffers.iter().copied());
        let mut placed = Camera::look_at(camera.eye.into(), camera.target.into())
            .up(camera.up.into())
            .field_of_view(camera.fov_degrees);
        if let Some(height) = camera.ortho {
            placed = placed.orthographic(height);
        }
        let part = self.part(request)?;
        let scene = part.as_deref().unwrap_or(&self.scene);
        let picture = renderer.render(scene, &placed, width, height);
        Ok((camera, picture.map_err(|error| error.to_string())?))
    }

    fn pick(&self, request: &Request) -> Result<Answer, String> {
        let (_, picture) = self.draw(request, &[Buffer::Voxel, Buffer::Node])?;
        let ([x, y], [width, height]) = (request.at, request.size);
        if x >= width || y >= height {
            return Err("this pixel is outside the picture".to_owned());
        }
        let at = y as usize * width as usize + x as usize;
        let voxels = picture.voxels().map_err(|error| error.to_string())?;
        let nodes = picture.nodes().map_err(|error| error.to_string())?;
        let part = self.part(request)?;
        let graph = part.as_deref().unwrap_or(&self.scene).graph();
        let place = &graph.placement;
        let color = graph.color_of(nodes[at] as u32);
        let (origin, size) = (place.world_origin, place.voxel_size);
        Ok(picked(voxels[at], color, graph.depth, origin, size))
    }

    /// As `view` places it. Drawing rejects cameras that see nothing.
    fn camera(&self, request: &Request) -> Result<Placed, String> {
        let [width, height] = request.size;
        let Some(camera) = &request.camera else {
            let fitted = Camera::fit(&self.scene).of_size(width, height);
            return fitted.map_err(|error| error.to_string());
        };
        let (points, fov_degrees) = camera.numbers();
        let [eye, target, up] = points.map(DVec3::from_array);
        Ok(Placed {
            eye,
            target,
            up,
            fov_degrees,
            ortho: camera.ortho,
            width,
            height,
        })
    }
}

impl Program for Opened {
    fn hello(&self) -> Value {
        json!({ "scenes": [self.name], "flags": {}, "size": null, "aa": 1, "warnings": self.scene.warnings() })
    }

    /// A worker gets no messages while it draws.
    fn drawer(
        &self,
        _is_stale: impl Fn() -> bool + Send + Sync + 'static,
    ) -> impl FnMut(&Request) -> Result<Answer, String> {
        |request| match request.ask {
            Ask::Picture => self.picture(request),
            Ask::Pick => self.pick(request),
            Ask::Figures => Err(
                "figures of the hardware: `shiftvox model`, or the page of `shiftvox view`"
                    .to_owned(),
            ),
        }
    }
}

/// The settings of a request's flags.
fn settings(request: &Request) -> Result<Renderer, String> {
    let mut renderer = Renderer::new().samples(request.aa).hashed(request.hash);
    let (mut bits, mut frac) = (64, None);
    for (name, value) in &request.flags {
        let wrong = || format!("--{name} has no value {value} here");
        let number = || value.parse::<f64>().map_err(|_| wrong());
        let whole = || value.parse::<u32>().map_err(|_| wrong());
        renderer = match (name.as_str(), value.as_str()) {
            ("coverage", "exact") => renderer.coverage(Coverage::Exact),
            ("coverage", "alpha") => renderer.coverage(Coverage::Alpha),
            ("coverage", "center") => renderer.coverage(Coverage::Center),
            ("coverage", "any") => renderer.coverage(Coverage::Any),
            ("cage", "frame") => renderer.cage(CageKind::Frame),
            ("cage", "corners") => renderer.cage(CageKind::Corners),
            ("engine", "fast") => renderer.engine(EngineKind::Fast),
            ("engine", "machine") => renderer.engine(EngineKind::Machine),
            ("engine", "rays") => renderer.engine(EngineKind::Rays),
            ("shade", "lambert") => renderer.shading(Shading::Lambert),
            ("shade", "flat") => renderer.shading(Shading::Flat),
            ("lod", _) => renderer.level_of_detail(number()?),
            // Of the scene, not of the renderer.
            ("crop", _) => renderer,
            ("background", _) => renderer.background(value.parse()?),
            ("tolerance", "inf") => renderer.tolerance(f64::INFINITY),
            ("tolerance", _) => renderer.tolerance(number()?),
            ("bits" | "frac", _) => {
                match name.as_str() {
                    "bits" => bits = whole()?,
                    _ => frac = Some(whole()?),
                }
                renderer
            }
            _ => return Err(wrong()),
        };
    }
    Ok(renderer.word(bits, frac))
}

/// Milliseconds of the page's clock. WebAssembly has none of its own.
#[cfg(target_family = "wasm")]
fn now() -> f64 {
    mod page {
        #[link(wasm_import_module = "page")]
        unsafe extern "C" {
            pub(super) safe fn now() -> f64;
        }
    }
    page::now()
}

#[cfg(not(target_family = "wasm"))]
fn now() -> f64 {
    use std::time::Instant;
    static BEGIN: std::sync::LazyLock<Instant> = std::sync::LazyLock::new(Instant::now);
    shiftvox::drawing::milliseconds_since(*BEGIN)
}
