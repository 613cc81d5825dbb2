//! Buffers written beside a picture: shapes, types, and that they agree.

use std::fs;
use std::path::Path;

use shiftvox::picture::npy::{self, Array, Values};
use shiftvox::picture::png;

use crate::common::Run;

const SIZE: (usize, usize) = (24, 16);

fn render(folder: &Path, aa: &str) {
    let mut command = crate::common::command();
    command.current_dir(folder).args([
        "render",
        "gen:sphere,depth=3",
        "--size",
        "24x16",
        "--aa",
        aa,
        "-o",
        "a.png",
        "--force",
        "--background",
        "none",
        "--aov",
        "depth,normal,voxel,node,records,color",
    ]);
    command.assert().success();
}

fn read(folder: &Path, name: &str) -> Array {
    npy::decode(&fs::read(folder.join(format!("a.{name}.npy"))).unwrap()).unwrap()
}

fn floats(array: &Array) -> &[f32] {
    match &array.values {
        Values::F32(values) => values,
        other => panic!("expected f32, found {other:?}"),
    }
}

fn integers(array: &Array) -> &[i32] {
    match &array.values {
        Values::I32(values) => values,
        other => panic!("expected i32, found {other:?}"),
    }
}

#[test]
fn shapes_types_and_agreement() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for aa in ["1", "2"] {
        render(folder, aa);
        let (width, height) = SIZE;
        let [depth, normal, voxel, node, records, color] =
            ["depth", "normal", "voxel", "node", "records", "color"].map(|n| read(folder, n));
        assert_eq!(depth.shape, [height, width]);
        assert_eq!(normal.shape, [height, width, 3]);
        assert_eq!(voxel.shape, [height, width, 4]);
        assert_eq!(node.shape, [height, width]);
        assert_eq!(records.shape, [height, width]);
        assert_eq!(color.shape, [height, width, 4]);
        let Values::U8(color) = &color.values else {
            panic!("colour is not u8");
        };
        let picture = png::decode(&fs::read(folder.join("a.png")).unwrap()).unwrap();
        assert_eq!(picture.rgba.as_flattened(), &color[..]);
        assert!(floats(&records).iter().sum::<f32>() > 0.0);
        let mut seen = 0;
        for at in 0..width * height {
            let drawn = integers(&node)[at] >= 0;
            seen += u32::from(drawn);
            assert_eq!(floats(&depth)[at].is_finite(), drawn);
            assert_eq!(integers(&voxel)[4 * at + 3] >= 0, drawn);
            let n = &floats(&normal)[3 * at..][..3];
            let length = n.iter().map(|c| c * c).sum::<f32>();
            assert!((length - f32::from(u8::from(drawn))).abs() < 1e-5);
            if aa == "1" {
                assert_eq!(color[4 * at + 3], if drawn { 255 } else { 0 });
            }
        }
        assert!(seen > 20, "{seen} pixels drawn");
        let alphas = color.iter().skip(3).step_by(4);
        let partial = alphas.filter(|&&alpha| alpha != 0 && alpha != 255).count();
        assert_eq!(partial > 0, aa == "2", "{partial} pixels partly covered");
    }
}
