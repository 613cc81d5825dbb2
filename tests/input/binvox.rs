//! Grids of the program binvox: runs of any length, and clear refusals.

use proptest::prelude::*;
use shiftvox::scene::{FileKind, ReadOptions, detect};

use crate::input_support::{cut_and_damaged, read, read_plain, refused};

const SMALL: &[u8] =
    b"#binvox 1\ndim 2 3 4\ntranslate -0.5 1 2e-3\nscale 7.25\ndata\n\x00\x05\x01\x03\x00\x10";

#[test]
fn y_runs_fastest_then_z_then_x() {
    assert_eq!(detect(SMALL, 0), Some(FileKind::Binvox));
    let most = |most_voxels| ReadOptions {
        most_voxels,
        ..ReadOptions::default()
    };
    let (voxels, info) = read(SMALL, &most(3)).unwrap();
    // Cells 5, 6 and 7 of 2 x 3 x 4 along x, z, y.
    assert!(
        voxels
            .iter()
            .map(|v| v.index)
            .eq([[0, 1, 1], [0, 2, 1], [0, 3, 1]])
    );
    assert_eq!((info.stored_voxels, info.warnings.len()), (3, 0));
    let (_, info) = read(&[SMALL, b"more"].concat(), &most(3)).unwrap();
    assert_eq!(info.warnings, ["4 bytes after the last run were not read"]);
    assert!(read(SMALL, &most(2)).unwrap_err().is_limit());
    cut_and_damaged(SMALL, SMALL.len(), 20_000);
}

#[test]
fn messages_say_where_and_what() {
    let sizes = "expected sizes from 1 to 2097151";
    let long = "#binvox 1\n".to_owned() + &"x".repeat(5000);
    let cases = [
        (
            "#binvox 3\n",
            "expected \"#binvox 1\" or \"#binvox 2\", found \"#binvox 3\"",
        ),
        (
            "#binvox 1\ndata\n",
            "header at byte 10: expected a line \"dim\"",
        ),
        ("#binvox 1\ndim 0 1 1\n", sizes),
        ("#binvox 1\ndim 1 1 2097152\n", sizes),
        (
            "#binvox 1\ndim 1 1\n",
            "expected dim, translate, scale or data",
        ),
        (
            "#binvox 1\ndim 1 1 1\n",
            "expected a line of at most 255 bytes",
        ),
        (&long, "expected a line of at most 255 bytes"),
        (
            "#binvox 1\ndim 1 1 1\ndim 1 1 1\n",
            "expected dim, translate",
        ),
        (
            "#binvox 1\ndim 1 1 4\ndata\n\x01\x05",
            "a run of at most 4 cells, found 5",
        ),
        (
            "#binvox 1\ndim 2097151 2097151 2097151\ndata\n\x00\x7f",
            "runs at byte 45: expected runs of 9223358842721533951 cells, found 127 cells",
        ),
    ];
    refused(cases.map(|(text, part)| (text.as_bytes().to_vec(), part)));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn runs_of_any_length_give_their_cells(
        ([x, z, y], cells) in [1usize..7, 1usize..7, 1usize..7].prop_flat_map(|sizes| {
            let cells = sizes.iter().product::<usize>();
            (Just(sizes), prop::collection::vec(prop::sample::select(&[0u8, 0, 1, 255][..]), cells))
        }),
        longest in 1usize..256,
    ) {
        let mut bytes = format!("#binvox 2\ndim {x} {z} {y}\ndata\n").into_bytes();
        for run in cells.chunk_by(|a, b| a == b) {
            for part in run.chunks(longest) {
                bytes.extend([part[0], part.len() as u8]);
            }
        }
        let filled = (0..cells.len()).filter(|&cell| cells[cell] != 0);
        let at = |cell| [cell / (z * y), cell % y, cell / y % z].map(|i| i as i32);
        let expected: Vec<_> = filled.map(|cell| (at(cell), [200; 3])).collect();
        prop_assert_eq!(read_plain(&bytes), expected);
    }
}
