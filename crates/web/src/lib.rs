//! The renderer for a page without a server, compiled to WebAssembly and run in a worker of the browser.
//!
//! A message's bytes are written to [`room`]. [`open`], [`ask`] and [`identity`] read them and return the length of their
//! answer. It is at [`answer`], in the form of the messages of `shiftvox view`.

#![allow(unsafe_code, reason = "names of exports")]

mod drawer;
mod frame_hash;
pub mod golden;

use std::cell::RefCell;

use serde_json::json;
use shiftvox_view::{Program, message};

use drawer::Opened;

#[derive(Default)]
struct State {
    input: Vec<u8>,
    answer: Vec<u8>,
    opened: Option<Opened>,
}

thread_local! {
    static STATE: RefCell<State> = RefCell::default();
}

/// Reads the input and keeps an answer; returns its length, bytes.
fn with(work: impl FnOnce(&[u8], &mut Option<Opened>) -> Vec<u8>) -> usize {
    STATE.with_borrow_mut(|state| {
        state.answer = work(&state.input, &mut state.opened);
        state.answer.len()
    })
}

/// A place for the input, `bytes` long.
#[unsafe(no_mangle)]
pub extern "C" fn room(bytes: usize) -> *mut u8 {
    STATE.with_borrow_mut(|state| {
        state.input.clear();
        state.input.resize(bytes, 0);
        state.input.as_mut_ptr()
    })
}

/// The last answer.
#[unsafe(no_mangle)]
pub extern "C" fn answer() -> *const u8 {
    STATE.with_borrow(|state| state.answer.as_ptr())
}

/// Opens a scene: a file's name, `name` bytes long, and its bytes. An empty name is that of the bundled scene. The answer
/// is the first message to a page, or an error, after which the scene before stays.
#[unsafe(no_mangle)]
pub extern "C" fn open(name: usize) -> usize {
    with(|input, opened| {
        let (name, bytes) = input.split_at(name.min(input.len()));
        match Opened::of(&String::from_utf8_lossy(name), bytes) {
            Ok(scene) => {
                let hello = shiftvox_view::hello(&scene);
                *opened = Some(scene);
                message((hello, Vec::new()))
            }
            Err(error) => message((json!({ "ask": "error", "error": error }), Vec::new())),
        }
    })
}

/// Answers a page's request.
#[unsafe(no_mangle)]
pub extern "C" fn ask() -> usize {
    with(|input, opened| {
        let request = String::from_utf8_lossy(input);
        let mut nothing = |_: &_| Err("there is no scene".to_owned());
        message(match opened {
            Some(scene) => shiftvox_view::answer(&mut scene.drawer(|| false), &request),
            None => shiftvox_view::answer(&mut nothing, &request),
        })
    })
}

/// Draws the golden pictures. The answer is text: their [`golden::identity`], then what differs from the golden rows.
#[unsafe(no_mangle)]
pub extern "C" fn identity() -> usize {
    with(|_, _| golden::report().into_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answered(length: usize) -> (serde_json::Value, Vec<u8>) {
        let bytes = STATE.with_borrow(|state| state.answer.clone());
        assert_eq!(bytes.len(), length);
        let (head, rest) = bytes.split_at(4);
        let head = u32::from_le_bytes(head.try_into().unwrap()) as usize;
        let head_text = serde_json::from_slice(&rest[..head]).unwrap();
        (head_text, rest[head..].to_vec())
    }

    fn put(bytes: &[u8]) {
        room(bytes.len());
        STATE.with_borrow_mut(|state| state.input.copy_from_slice(bytes));
    }

    #[test]
    fn a_page_draws_the_pictures_of_the_library() {
        put(b"");
        assert_eq!(answered(open(0)).0["ask"], "hello");
        put(br#"{"seq":7,"ask":"picture","scene":0,"size":[64,48],"aa":2,"flags":{"coverage":"center"},"hash":true}"#);
        let (head, picture) = answered(ask());
        let scene = shiftvox::Scene::from_bytes(shiftvox::scene::BUNDLED_TREE, "tree.vox").unwrap();
        let expected = shiftvox::Renderer::new()
            .coverage(shiftvox::Coverage::Center)
            .samples(2)
            .hashed(true)
            .render(&scene, &shiftvox::Camera::fit(&scene), 64, 48)
            .unwrap();
        assert_eq!(head["hash"], expected.hash().unwrap(), "{head}");
        assert_eq!(head["seq"], 7);
        assert_eq!(picture, expected.rgba().as_flattened());
        put(br#"{"seq":8,"ask":"pick","scene":0,"size":[64,48],"aa":2,"at":[32,20]}"#);
        let (head, _) = answered(ask());
        let voxels = shiftvox::Renderer::new()
            .samples(2)
            .buffers([shiftvox::Buffer::Voxel])
            .render(&scene, &shiftvox::Camera::fit(&scene), 64, 48)
            .unwrap();
        let (index, level) = voxels.voxel_at(32, 20).unwrap().unwrap();
        assert_eq!(head["voxel"]["index"], json!(index), "{head}");
        assert_eq!(head["voxel"]["level"], level);
        for (request, reason) in [
            (
                r#"{"seq":1,"ask":"pick","scene":0,"size":[64,48],"aa":1,"at":[64,0]}"#,
                "outside",
            ),
            (
                r#"{"seq":1,"ask":"figures","scene":0,"size":[64,48],"aa":1}"#,
                "shiftvox model",
            ),
            (
                r#"{"seq":1,"ask":"picture","scene":0,"size":[64,48],"aa":1,"flags":{"lod":"x"}}"#,
                "lod",
            ),
            (
                r#"{"seq":1,"ask":"picture","scene":0,"size":[64,0],"aa":1}"#,
                "pixels",
            ),
            ("{", "not understood"),
        ] {
            put(request.as_bytes());
            let (head, _) = answered(ask());
            let error = head["error"].as_str().unwrap();
            assert!(error.contains(reason), "{error}");
        }
        put(b"a.voxnonsense");
        let refused = answered(open(5)).0;
        assert_eq!(refused["ask"], "error", "{refused}");
    }
}
