//! One HTML file with tables, plots as SVG and pictures as data. It opens without a network and without scripts.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::table::{Cell, Table};

const STYLE: &str = "\
:root{color-scheme:light dark;--soft:#78808a;--line:#8884;--band:#8881}
body{margin:0 auto;max-width:min(1800px,100%);padding:2rem 1.25rem;font:16px/1.5 system-ui,sans-serif}
.scroll{overflow-x:auto}
table{border-collapse:collapse;font-size:.86rem;font-variant-numeric:tabular-nums}
th,td{padding:.25rem .45rem;border-bottom:1px solid var(--line);text-align:right;white-space:nowrap}
th{white-space:normal;vertical-align:bottom}
td.w,th.w{text-align:left;white-space:normal;min-width:7.5rem;max-width:40rem}
tbody tr:nth-child(even),pre{background:var(--band)}
pre{padding:.7rem .9rem;overflow-x:auto}
figure{display:inline-block;margin:1rem 1rem 0 0}
figure img,figure svg{max-width:100%;height:auto;image-rendering:pixelated;background:#fff}
figcaption{color:var(--soft);font-size:.88rem}
";

#[derive(Debug, Clone)]
pub struct Page<'p> {
    pub title: &'p str,
    pub preface: &'p str,
    pub pictures: &'p [(&'p [u8], &'p str)],
    pub tables: &'p [Table],
    pub plots: &'p str,
    pub details: &'p [Table],
}

pub(super) fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;").replace('"', "&quot;")
}

impl Page<'_> {
    pub fn finish(&self) -> String {
        let title = escaped(self.title);
        let mut html = format!(
            "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
             <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\
             <title>{title}</title>\n<style>\n{STYLE}</style></head>\n<body>\n<h1>{title}</h1>\n<pre>{}</pre>\n",
            escaped(self.preface)
        );
        for (png, caption) in self.pictures {
            let (caption, data) = (escaped(caption), STANDARD.encode(png));
            html += &format!(
                "<figure><img alt=\"{caption}\" src=\"data:image/png;base64,{data}\">\
                 <figcaption>{caption}</figcaption></figure>\n"
            );
        }
        html.extend(self.tables.iter().map(of_table));
        // The declaration of an XML file is not part of a page.
        html += self.plots.find("<svg").map_or("", |at| &self.plots[at..]);
        html.extend(self.details.iter().map(of_table));
        html + "</body></html>\n"
    }
}

fn of_table(table: &Table) -> String {
    let class = |column: usize| match table.is_of_words(column) {
        true => " class=\"w\"",
        false => "",
    };
    let title = escaped(&table.title);
    let mut html = format!("<h2>{title}</h2>\n<div class=\"scroll\"><table><thead><tr>");
    for (column, name) in table.columns.iter().enumerate() {
        let name = escaped(&name.replace('_', " "));
        let _ = write!(html, "<th{}>{name}</th>", class(column));
    }
    html += "</tr></thead><tbody>";
    for row in &table.rows {
        html += "<tr>";
        for (column, cell) in row.iter().enumerate() {
            let text = escaped(&Cell::for_people(cell));
            let _ = write!(html, "<td{}>{text}</td>", class(column));
        }
        html += "</tr>";
    }
    html + "</tbody></table></div>\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_escapes_what_it_shows() {
        let table = Table {
            rows: vec![vec!["<script>".into(), Cell::Count(1234)]],
            ..Table::new("T<1>", &["scene_name", "records"])
        };
        let head = "<h2>T&lt;1&gt;</h2>\n<div class=\"scroll\"><table><thead><tr><th class=\"w\">scene name</th>\
                    <th>records</th></tr></thead><tbody>";
        let row = "<tr><td class=\"w\">&lt;script&gt;</td><td>1,234</td></tr>";
        assert_eq!(
            of_table(&table),
            format!("{head}{row}</tbody></table></div>\n")
        );
        assert_eq!(escaped("\"a\" & b"), "&quot;a&quot; &amp; b");
    }
}
