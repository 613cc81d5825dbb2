//! What makes each block: the files `docs/evidence/*.toml`, one a page.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;

/// Named texts that `{name}` stands for.
pub(crate) type Vars = BTreeMap<String, String>;

/// A page and its blocks.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Page {
    /// Path from the root of the repository.
    pub(crate) page: String,
    /// Texts that all blocks may use.
    #[serde(default)]
    pub(crate) vars: Vars,
    /// Files that commands share, by name, with the command that makes each; `{file:NAME}` is its path.
    #[serde(default)]
    pub(crate) prepare: Vars,
    /// In any order.
    #[serde(default)]
    pub(crate) block: Vec<Block>,
}

/// What stands between `<!-- evidence: NAME -->` and `<!-- end: NAME -->`: a table, pictures, or both.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Block {
    /// Unique among all pages.
    pub(crate) name: String,
    /// Whether `--check` computes its figures.
    #[serde(default)]
    pub(crate) cost: Cost,
    /// `valgrind` or `meshes`: what must be there for it.
    #[serde(default)]
    pub(crate) needs: Vec<String>,
    /// Commands by the name that expressions use.
    #[serde(default)]
    pub(crate) runs: BTreeMap<String, Run>,
    /// Rows become columns.
    #[serde(default)]
    pub(crate) transpose: bool,
    /// Of the table.
    #[serde(default)]
    pub(crate) columns: Vec<Column>,
    /// Of the table.
    #[serde(default)]
    pub(crate) rows: Vec<Row>,
    /// Plots and pictures.
    #[serde(default)]
    pub(crate) pictures: Vec<Picture>,
}

/// How long a block takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Cost {
    /// Seconds: checked in CI.
    Quick,
    /// More: checked on demand.
    #[default]
    Long,
}

/// A command, without the leading `shiftvox` and the trailing `--json`.
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged)]
pub(crate) enum Run {
    /// Its JSON is the value.
    Command(String),
    /// One after the other in a folder of their own, `{tmp}`; the JSON of the last is the value.
    Steps(Vec<String>),
    /// Instructions under callgrind: a number.
    Instructions {
        /// The command.
        instructions: String,
    },
    /// `wall_s`, `cpu_s` and `peak_mb` of the command.
    Measured {
        /// The command.
        measured: String,
    },
}

impl Run {
    /// The commands, in order.
    pub(crate) fn steps(&self) -> Vec<&str> {
        match self {
            Self::Command(one)
            | Self::Instructions { instructions: one }
            | Self::Measured { measured: one } => vec![one],
            Self::Steps(steps) => steps.iter().map(String::as_str).collect(),
        }
    }
}

/// Whether figures are the same in every run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Kind {
    /// The same on every machine, for one version of the program: checked.
    #[default]
    Exact,
    /// Of one machine and moment: shown only.
    Time,
    /// Instructions counted by callgrind: shown only.
    Instructions,
}

/// A column: either `text` or `value`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Column {
    /// Its head.
    pub(crate) head: String,
    /// Words, with variables of the row.
    pub(crate) text: Option<String>,
    /// One expression, or several for a `show` with as many braces.
    pub(crate) value: Option<OneOrMore>,
    /// How to print it: see `format.rs`.
    #[serde(default = "plain")]
    pub(crate) show: String,
    /// Whether it is checked.
    #[serde(default)]
    pub(crate) kind: Kind,
}

fn plain() -> String {
    ",".to_owned()
}

/// One expression or a list.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
pub(crate) enum OneOrMore {
    /// One.
    One(String),
    /// Several.
    More(Vec<String>),
}

impl OneOrMore {
    /// As a list.
    pub(crate) fn list(&self) -> &[String] {
        match self {
            Self::One(one) => std::slice::from_ref(one),
            Self::More(more) => more,
        }
    }
}

/// A row, or with `each` a row for each element of an array.
#[derive(Debug, Deserialize)]
pub(crate) struct Row {
    /// The array; its element is `row` in expressions.
    pub(crate) each: Option<String>,
    /// Another cost than the block's.
    pub(crate) cost: Option<Cost>,
    /// Variables.
    #[serde(flatten)]
    pub(crate) vars: BTreeMap<String, toml::Value>,
}

impl Row {
    /// Its variables over those of the page.
    pub(crate) fn vars(&self, page: &Vars) -> Vars {
        let mut vars = page.clone();
        for (name, value) in &self.vars {
            let text = match value {
                toml::Value::String(text) => text.clone(),
                other => other.to_string(),
            };
            vars.insert(name.clone(), text);
        }
        vars
    }
}

/// A picture that a run makes.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Picture {
    /// Path from the root of the repository.
    pub(crate) file: String,
    /// What it shows.
    pub(crate) alt: String,
    /// The run that makes it, in its `{tmp}`.
    pub(crate) run: String,
    /// The file's name there.
    pub(crate) made: String,
    /// Whether its bytes are checked.
    #[serde(default)]
    pub(crate) kind: Kind,
    /// Whether the block shows it, or another part of the page does.
    #[serde(default = "yes")]
    pub(crate) shown: bool,
}

fn yes() -> bool {
    true
}

/// What the text rules let pass: `docs/evidence/allow.toml`.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Allow {
    /// Tables of figures that no command makes.
    #[serde(default)]
    pub(crate) table: Vec<Allowed>,
    /// Plots that no command makes.
    #[serde(default)]
    pub(crate) plot: Vec<Allowed>,
    /// Words that sound like a stale page and are none.
    #[serde(default)]
    pub(crate) phrase: Vec<Allowed>,
}

/// One exception.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Allowed {
    /// Path from the root of the repository.
    pub(crate) page: String,
    /// The beginning of the table's head, the plot's path, or the words with some around them.
    pub(crate) text: String,
    /// Why.
    pub(crate) reason: String,
}

/// All pages, and what is let pass.
#[derive(Debug)]
pub(crate) struct Registry {
    /// By file name.
    pub(crate) pages: Vec<Page>,
    /// Exceptions.
    pub(crate) allow: Allow,
}

impl Registry {
    /// Reads the folder.
    pub(crate) fn read(folder: &Path) -> Result<Self, String> {
        let entries = std::fs::read_dir(folder)
            .map_err(|e| format!("cannot read {}: {e}", folder.display()))?;
        let mut files: Vec<_> = entries
            .filter_map(|entry| entry.ok().map(|e| e.path()))
            .filter(|path| path.extension().is_some_and(|e| e == "toml"))
            .collect();
        files.sort();
        let mut registry = Self {
            pages: Vec::new(),
            allow: Allow::default(),
        };
        for file in files {
            let wrong = |e: &dyn std::fmt::Display| format!("{}: {e}", file.display());
            let text = std::fs::read_to_string(&file).map_err(|e| wrong(&e))?;
            if file.file_name().is_some_and(|name| name == "allow.toml") {
                registry.allow = toml::from_str(&text).map_err(|e| wrong(&e))?;
            } else {
                registry
                    .pages
                    .push(toml::from_str(&text).map_err(|e| wrong(&e))?);
            }
        }
        let mut names: Vec<&str> = registry.blocks().map(|(_, b)| b.name.as_str()).collect();
        names.sort_unstable();
        match names.windows(2).find(|pair| pair[0] == pair[1]) {
            Some(pair) => Err(format!("two blocks are named {}", pair[0])),
            None => Ok(registry),
        }
    }

    /// Every block with its page.
    pub(crate) fn blocks(&self) -> impl Iterator<Item = (&Page, &Block)> {
        self.pages
            .iter()
            .flat_map(|page| page.block.iter().map(move |block| (page, block)))
    }
}

/// Puts variables in place of `{name}`; what names no variable stays.
pub(crate) fn substitute(template: &str, vars: &Vars) -> String {
    let mut text = template.to_owned();
    // Variables may name variables.
    for _ in 0..4 {
        let before = text.clone();
        for (name, value) in vars {
            text = text.replace(&format!("{{{name}}}"), value);
        }
        if text == before {
            break;
        }
    }
    text
}
