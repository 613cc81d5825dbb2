//! Buffers written beside a picture: shapes, types, and that they agree.

use shiftvox::picture::npy::{self, Values};
use shiftvox::picture::png;

use crate::program::Folder;

#[test]
fn shapes_types_and_agreement() {
    for aa in [1, 2] {
        let folder = Folder::new();
        folder.run(
            &format!(
                "render gen:sphere,depth=3 --size 24x16 --aa {aa} -o a.png --background none \
                 --aov depth,normal,voxel,node,records,color"
            ),
            0,
        );
        let read = |name: &str| npy::decode(&folder.get(&format!("a.{name}.npy"))).unwrap();
        let all = ["depth", "records", "normal", "voxel", "node", "color"].map(read);
        let shapes = all.each_ref().map(|array| &array.shape[..]);
        let [flat, vector, four]: [&[usize]; 3] = [&[16, 24], &[16, 24, 3], &[16, 24, 4]];
        assert_eq!(shapes, [flat, flat, vector, four, flat, four]);
        let [
            Values::F32(depth),
            Values::F32(records),
            Values::F32(normal),
            Values::I32(voxel),
            Values::I32(node),
            Values::U8(color),
        ] = all.map(|array| array.values)
        else {
            panic!("wrong types");
        };
        let picture = png::decode(&folder.get("a.png")).unwrap();
        assert_eq!(picture.rgba.as_flattened(), &color[..]);
        assert!(records.iter().sum::<f32>() > 0.0);
        for (at, node) in node.iter().enumerate() {
            let is_drawn = *node >= 0;
            assert_eq!(depth[at].is_finite(), is_drawn);
            assert_eq!(voxel[4 * at + 3] >= 0, is_drawn);
            let squares = normal[3 * at..][..3].iter().map(|c| c * c);
            let length: f32 = squares.sum();
            assert!((length - f32::from(u8::from(is_drawn))).abs() < 1e-5);
            assert!(aa == 2 || color[4 * at + 3] == 255 * u8::from(is_drawn));
        }
        assert!(node.iter().filter(|node| **node >= 0).count() > 20);
        let mut alphas = color.iter().skip(3).step_by(4);
        let has_partial = alphas.any(|&alpha| alpha != 0 && alpha != 255);
        assert_eq!(has_partial, aa == 2);
    }
}
