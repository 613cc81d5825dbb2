//! The page without a server, in a real browser: `crates/web/page/make FOLDER`, then `SHIFTVOX_PAGE=FOLDER`.

use std::io::{BufRead, BufReader, Write};
use std::net::TcpListener;
use std::path::{Path, PathBuf};

use crate::browser::assert_is_renders;
use crate::chromium::Browser;

/// Serves the files of folders. Returns their address.
fn serve(folders: Vec<PathBuf>) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    std::thread::spawn(move || {
        for stream in listener.incoming() {
            let mut stream = stream.unwrap();
            let mut lines = BufReader::new(&stream).lines().map_while(Result::ok);
            let request = lines.next().unwrap_or_default();
            let _ = lines.take_while(|line| !line.is_empty()).count();
            let name = request.split(' ').nth(1).unwrap_or_default();
            let name = Path::new(name).file_name().unwrap_or("index.html".as_ref());
            let found = folders
                .iter()
                .find_map(|folder| std::fs::read(folder.join(name)).ok());
            let (status, bytes) = match found {
                Some(bytes) => ("200 OK", bytes),
                None => ("404 Not Found", Vec::new()),
            };
            let kind = match name.to_str().unwrap().rsplit_once('.') {
                Some((_, "html")) => "text/html",
                Some((_, "js")) => "text/javascript",
                _ => "application/wasm",
            };
            let length = bytes.len();
            let head = format!(
                "HTTP/1.1 {status}\r\ncontent-type: {kind}\r\ncontent-length: {length}\r\nconnection: close\r\n\r\n"
            );
            let _ = stream.write_all(&[head.as_bytes(), &bytes].concat());
        }
    });
    format!("http://{address}/")
}

#[test]
#[ignore = "needs SHIFTVOX_PAGE"]
fn the_page_without_a_server_shows_what_render_draws() {
    let page = std::env::var_os("SHIFTVOX_PAGE")
        .expect("SHIFTVOX_PAGE")
        .into();
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data");
    let browser = &mut Browser::open(&serve(vec![page, data]));
    assert!(assert_is_renders(browser).contains("assets/tree.vox"));
    browser.set("coverage", "any");
    assert!(assert_is_renders(browser).contains("--coverage=any"));
    browser.set("coverage", "");
    browser.drag([430.0, 400.0], [500.0, 360.0], "left");
    assert_is_renders(browser);
    browser.value("pickAt(0.5, 0.5)");
    browser.wait("voxel && $('voxel').innerText.includes('level')");
    // Times of whole frames, for the documents.
    let times = browser.value(
        "new Promise((done) => { const times = [];
           const next = () => fast.ask(question([1024, 1024], {}), (head) => {
             times.push(head.draw_ms); times.length < 9 ? next() : done(times.sort((a, b) => a - b)); });
           next(); })",
    );
    println!("ms of frames of 1024 x 1024: {times}");
    browser.shot("without-server.png");
    let open =
        |bytes: &str, name: &str| format!("(async () => take(new File([{bytes}], '{name}')))()");
    browser.value(&open(
        "await (await fetch('axes.vox')).arrayBuffer()",
        "tests/data/axes.vox",
    ));
    browser.wait("document.title.startsWith('tests/data/axes.vox')");
    assert!(assert_is_renders(browser).contains("tests/data/axes.vox"));
    browser.set("background", "none");
    assert!(assert_is_renders(browser).contains("--background=none"));
    browser.value(
        "new Promise((done) => { const save = download; download = (file, name) => {
           download = save; done(1); if (name !== 'turntable.png' || file.size < 10000) throw name; };
           $('turn').click(); })",
    );
    browser.value(&open("'nonsense'", "wrong.vox"));
    browser.wait("$('of-file').textContent.includes('wrong.vox')");
    // Memory grows.
    browser.value(&open("new Uint8Array(64 << 20)", "large.vox"));
    browser.wait("$('of-file').textContent.includes('large.vox')");
    browser.drag([430.0, 400.0], [500.0, 360.0], "left");
    assert!(assert_is_renders(browser).contains("tests/data/axes.vox"));
}
