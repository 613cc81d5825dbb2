//! temporary
use shiftvox::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let size: u32 = a[1].parse().unwrap();
    let cov = match a[2].as_str() {
        "exact" => Coverage::Exact,
        "any" => Coverage::Any,
        "center" => Coverage::Center,
        _ => Coverage::Alpha,
    };
    let buffers: Vec<Buffer> = match a[3].as_str() {
        "color" => vec![],
        "all" => vec![
            Buffer::Depth,
            Buffer::Normal,
            Buffer::Voxel,
            Buffer::Node,
            Buffer::Records,
            Buffer::Color,
        ],
        "depth" => vec![Buffer::Depth],
        _ => vec![Buffer::Normal],
    };
    let samples: u32 = a[4].parse().unwrap();
    let threads: usize = a[5].parse().unwrap();
    let engine = match a[6].as_str() {
        "fast" => EngineKind::Fast,
        "machine" => EngineKind::Machine,
        _ => EngineKind::Rays,
    };
    let what = a[7].as_str();
    let scene = match Scene::generate("menger,depth=2") {
        Ok(s) => s,
        Err(e) => {
            println!("scene: {e}");
            return;
        }
    };
    let camera = Camera::fit(&scene);
    let r = Renderer::new()
        .coverage(cov)
        .buffers(buffers)
        .samples(samples)
        .threads(threads)
        .engine(engine)
        .hashed(what == "hash");
    if what == "into" {
        let Ok(mut px) = (|| {
            let mut v = Vec::new();
            v.try_reserve_exact((size * size) as usize).map(|()| {
                v.resize((size * size) as usize, [0; 4]);
                v
            })
        })() else {
            println!("no pixels");
            return;
        };
        match r
            .buffers([])
            .render_into(&scene, &camera, size, size, &mut px)
        {
            Ok(_) => println!("drawn"),
            Err(e) => println!("{e:?}"),
        }
        return;
    }
    match r.render(&scene, &camera, size, size) {
        Ok(p) => {
            println!("drawn {}", p.width());
            if what == "png" {
                println!("{:?}", p.save_png("/dev/shm/attack.png"));
            }
            if what == "npy" {
                println!("{:?}", p.save_npy(Buffer::Color, "/dev/shm/attack.npy"));
            }
        }
        Err(e) => println!("{e:?}"),
    }
}
