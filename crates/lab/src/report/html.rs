//! One HTML file that holds everything it shows: text, tables, plots as SVG,
//! pictures as data. It opens anywhere, without a network and without scripts.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::table::{Cell, Table};

/// A page in the making.
#[derive(Debug, Clone)]
pub struct Page {
    title: String,
    /// Headings with the anchors that lead to them.
    contents: Vec<(String, String)>,
    body: String,
}

/// How pages look: on paper-white and at night.
const STYLE: &str = "\
:root{color-scheme:light dark;--ink:#1c1f23;--soft:#5b636d;--line:#d9dde2;--page:#fff;--band:#f5f6f8;--link:#0b63a5}
@media(prefers-color-scheme:dark){:root{--ink:#e6e8eb;--soft:#a0a8b2;--line:#3a4048;--page:#16181b;--band:#1f2226;--link:#7cc0f5}}
*{box-sizing:border-box}
body{margin:0;background:var(--page);color:var(--ink);font:16px/1.55 system-ui,-apple-system,Segoe UI,sans-serif}
main{max-width:min(1800px,100%);margin:0 auto;padding:2rem 1.25rem 5rem}
h1{font-size:1.9rem;line-height:1.2;margin:.2em 0 .4em}
h2{font-size:1.35rem;margin:2.4em 0 .5em;padding-top:.5em;border-top:1px solid var(--line)}
h3{font-size:1.05rem;margin:1.6em 0 .4em}
p,li{max-width:76ch}
a{color:var(--link)}
nav ul{max-width:76rem;columns:3 16rem;padding-left:1.1rem;margin:.6rem 0 1rem}
.scroll{overflow-x:auto;margin:.6rem 0 1.2rem}
table{border-collapse:collapse;font-size:.86rem;font-variant-numeric:tabular-nums}
caption{caption-side:top;text-align:left;color:var(--soft);padding:.2rem 0 .4rem}
th,td{padding:.25rem .45rem;border-bottom:1px solid var(--line);text-align:right;white-space:nowrap}
th{white-space:normal;vertical-align:bottom;position:sticky;top:0;background:var(--page);border-bottom:2px solid var(--line)}
td.w,th.w{text-align:left}
td.w{white-space:normal;min-width:7.5rem}
td.long{min-width:20rem}
tbody tr:nth-child(even){background:var(--band)}
pre{background:var(--band);padding:.7rem .9rem;overflow-x:auto;font-size:.84rem;border-radius:6px}
figure{margin:1rem 0}
figure img{max-width:100%;height:auto;image-rendering:pixelated;border:1px solid var(--line);background:#000}
figure svg{max-width:min(900px,100%);height:auto;background:#fff}
figcaption{color:var(--soft);font-size:.88rem;margin-top:.3rem}
.row{display:flex;flex-wrap:wrap;gap:1rem}
.row figure{flex:1 1 300px;margin:.4rem 0}
.key{display:grid;grid-template-columns:repeat(auto-fit,minmax(11rem,1fr));gap:.7rem;margin:1rem 0}
.key div{background:var(--band);border-radius:8px;padding:.6rem .8rem}
.key b{display:block;font-size:1.25rem}
.key span{color:var(--soft);font-size:.84rem}
";

/// Most bytes of text in one line of a cell.
const LONG: usize = 60;

/// Text as HTML shows it.
#[must_use]
pub fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            other => escaped.push(other),
        }
    }
    escaped
}

impl Page {
    /// An empty page.
    #[must_use]
    pub fn new(title: &str) -> Self {
        Self {
            title: title.to_owned(),
            contents: Vec::new(),
            body: String::new(),
        }
    }

    fn push(&mut self, html: std::fmt::Arguments<'_>) {
        // Writing to a string does not fail.
        let _ = self.body.write_fmt(html);
        self.body.push('\n');
    }

    /// Begins a chapter, which the contents name.
    pub fn chapter(&mut self, heading: &str) {
        let anchor = format!("c{}", self.contents.len() + 1);
        self.push(format_args!(
            "<h2 id=\"{anchor}\">{}</h2>",
            escaped(heading)
        ));
        self.contents.push((anchor, heading.to_owned()));
    }

    /// Begins a section.
    pub fn section(&mut self, heading: &str) {
        self.push(format_args!("<h3>{}</h3>", escaped(heading)));
    }

    /// A paragraph.
    pub fn text(&mut self, text: &str) {
        self.push(format_args!("<p>{}</p>", escaped(text)));
    }

    /// Lines as they are, such as a command.
    pub fn lines(&mut self, text: &str) {
        self.push(format_args!("<pre>{}</pre>", escaped(text)));
    }

    /// Key figures: value and meaning.
    pub fn key_figures(&mut self, figures: &[(String, String)]) {
        let mut html = String::from("<div class=\"key\">");
        for (value, what) in figures {
            let _ = write!(
                html,
                "<div><b>{}</b><span>{}</span></div>",
                escaped(value),
                escaped(what)
            );
        }
        self.push(format_args!("{html}</div>"));
    }

    /// A table under its title.
    pub fn table(&mut self, table: &Table) {
        let class = |column: usize, text: &str| match (table.is_of_words(column), text.len()) {
            (false, _) => "",
            (true, ..=LONG) => " class=\"w\"",
            (true, _) => " class=\"w long\"",
        };
        let mut html = format!(
            "<div class=\"scroll\"><table><caption>{}</caption><thead><tr>",
            escaped(&table.title)
        );
        for (column, name) in table.columns.iter().enumerate() {
            let name = escaped(&name.replace('_', " "));
            let _ = write!(html, "<th{}>{name}</th>", class(column, ""));
        }
        html.push_str("</tr></thead><tbody>");
        for row in &table.rows {
            html.push_str("<tr>");
            for (column, cell) in row.iter().enumerate() {
                let text = escaped(&Cell::for_people(cell));
                let _ = write!(html, "<td{}>{text}</td>", class(column, &text));
            }
            html.push_str("</tr>");
        }
        self.push(format_args!("{html}</tbody></table></div>"));
    }

    /// A plot, as the SVG text that draws it.
    pub fn plot(&mut self, svg: &str, caption: &str) {
        // A declaration may only stand at the beginning of a file.
        let drawing = svg.find("<svg").map_or("", |at| &svg[at..]);
        self.push(format_args!(
            "<figure>{drawing}<figcaption>{}</figcaption></figure>",
            escaped(caption)
        ));
    }

    /// Pictures side by side: PNG files and captions.
    pub fn pictures(&mut self, pictures: &[(&[u8], &str)]) {
        let mut html = String::from("<div class=\"row\">");
        for (png, caption) in pictures {
            let caption = escaped(caption);
            let _ = write!(
                html,
                "<figure><img alt=\"{caption}\" src=\"data:image/png;base64,{}\"><figcaption>{caption}</figcaption></figure>",
                STANDARD.encode(png)
            );
        }
        self.push(format_args!("{html}</div>"));
    }

    /// The page as a file.
    #[must_use]
    pub fn finish(&self) -> String {
        let mut contents = String::new();
        for (anchor, heading) in &self.contents {
            let heading = escaped(heading);
            let _ = write!(contents, "<li><a href=\"#{anchor}\">{heading}</a></li>");
        }
        format!(
            "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
             <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\
             <title>{title}</title>\n<style>\n{STYLE}</style></head>\n<body><main>\n<h1>{title}</h1>\n\
             <nav><ul>{contents}</ul></nav>\n{body}</main></body></html>\n",
            title = escaped(&self.title),
            body = self.body,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_holds_what_it_shows_and_escapes_it() {
        let mut page = Page::new("a < b");
        page.chapter("Times & sizes");
        page.text("\"quoted\"");
        let mut table = Table::new("T<1>", &["scene_name", "records"]);
        table
            .rows
            .push(vec![Cell::from("<script>"), Cell::from(1234)]);
        let sentence =
            "what is said in a sentence is broken into lines, or its end is out of sight";
        table.rows.push(vec![Cell::from(sentence), Cell::from(5)]);
        page.table(&table);
        page.plot("<?xml version=\"1.0\"?>\n<svg width=\"1\"></svg>", "a plot");
        page.pictures(&[(&[1, 2, 3], "three bytes")]);
        let html = page.finish();
        assert!(html.contains("<title>a &lt; b</title>"));
        assert!(html.contains("<li><a href=\"#c1\">Times &amp; sizes</a></li>"));
        assert!(html.contains("<h2 id=\"c1\">Times &amp; sizes</h2>"));
        assert!(html.contains("<td class=\"w\">&lt;script&gt;</td><td>1,234</td>"));
        assert!(html.contains("<th class=\"w\">scene name</th>"));
        assert!(html.contains("<td class=\"w long\">what is said"));
        assert!(html.contains("<figure><svg width=\"1\"></svg>"));
        assert!(html.contains("data:image/png;base64,AQID"));
        assert!(!html.contains("<?xml") && !html.contains("<script"));
    }
}
