//! Keeps the tables and plots of the documentation equal to what their commands say.

pub(crate) mod expression;
pub(crate) mod format;
pub(crate) mod grid;
pub(crate) mod page;
pub(crate) mod registry;
pub(crate) mod runs;
pub(crate) mod words;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use grid::{Grid, Select};
use registry::{Block, Page, Registry};
use runs::{Concrete, Runs};

/// Whether instructions can be counted.
pub(crate) fn has_valgrind() -> bool {
    std::process::Command::new("valgrind")
        .arg("--version")
        .output()
        .is_ok_and(|output| output.status.success())
}

/// The pages, the registry, and the program that makes the figures.
#[derive(Debug)]
pub(crate) struct Tool {
    root: PathBuf,
    registry: Registry,
    program: PathBuf,
}

/// What is checked or remade.
#[derive(Debug, Default)]
pub(crate) struct Wanted {
    /// Blocks or pages; all if there are none.
    pub(crate) names: Vec<String>,
    /// Those that take long, too.
    pub(crate) long: bool,
    /// Times and instructions, too.
    pub(crate) times: bool,
}

impl Tool {
    /// Reads the registry.
    pub(crate) fn open(root: &Path, program: &Path) -> Result<Self, String> {
        let registry = Registry::read(&root.join("docs/evidence"))?;
        Ok(Self {
            root: root.to_owned(),
            registry,
            program: program.to_owned(),
        })
    }

    fn read(&self, page: &str) -> Result<String, String> {
        std::fs::read_to_string(self.root.join(page)).map_err(|e| format!("{page}: {e}"))
    }

    /// README, the pages under `docs`, and those that the registry names.
    fn pages(&self) -> Result<Vec<(String, String)>, String> {
        let mut names = BTreeSet::from(["README.md".to_owned(), "ARCHITECTURE.md".to_owned()]);
        let docs = std::fs::read_dir(self.root.join("docs")).map_err(|e| format!("docs: {e}"))?;
        for entry in docs.filter_map(Result::ok) {
            let name = entry.file_name().to_string_lossy().into_owned();
            if name.ends_with(".md") {
                names.insert(format!("docs/{name}"));
            }
        }
        names.extend(self.registry.pages.iter().map(|p| p.page.clone()));
        names
            .into_iter()
            .map(|name| self.read(&name).map(|text| (name, text)))
            .collect()
    }

    fn chosen<'a>(&'a self, wanted: &Wanted) -> Result<Vec<(&'a Page, &'a Block)>, String> {
        for name in &wanted.names {
            if !self
                .registry
                .blocks()
                .any(|(p, b)| p.page == *name || b.name == *name)
            {
                return Err(format!(
                    "there is no block and no page `{name}`; --list tells them"
                ));
            }
        }
        let chosen = self.registry.blocks().filter(|(page, block)| {
            wanted.names.is_empty()
                || wanted.names.contains(&page.page)
                || wanted.names.contains(&block.name)
        });
        Ok(chosen.collect())
    }

    /// Faults of the text alone, found without drawing anything.
    pub(crate) fn text_faults(&self) -> Result<Vec<String>, String> {
        let pages = self.pages()?;
        let mut faults = words::unused(&self.registry.allow, &pages);
        for (name, text) in &pages {
            let blocks = match page::blocks(text) {
                Ok(blocks) => blocks,
                Err(error) => {
                    faults.push(format!("{name}: {error}"));
                    continue;
                }
            };
            let ranges: Vec<_> = blocks.iter().map(|(_, range)| range.clone()).collect();
            faults.extend(words::faults(name, text, &ranges, &self.registry.allow));
            for (block, _) in &blocks {
                if !self
                    .registry
                    .blocks()
                    .any(|(p, b)| p.page == *name && b.name == *block)
                {
                    faults.push(format!(
                        "{name}: the registry has no block `{block}` of this page"
                    ));
                }
            }
            faults.extend(self.plot_faults(name, text));
        }
        let none = Select {
            long: false,
            times: false,
        };
        let runs = Runs::new(&self.program, &self.root)?;
        for (page, block) in self.registry.blocks() {
            let text = self.read(&page.page)?;
            let lines: Vec<&str> = text.lines().collect();
            let Some(range) = range_of(&text, &block.name) else {
                faults.push(format!("{}: has no block `{}`", page.page, block.name));
                continue;
            };
            let inside = &lines[range];
            if let Some(fault) = page::foot_fault(page, block, inside) {
                faults.push(format!("{}, {}: {fault}", page.page, block.name));
            }
            if let Err(error) = grid::needed(
                page,
                block,
                Select {
                    long: true,
                    times: true,
                },
            ) {
                faults.push(error);
            }
            // Of a block that takes long, the words are known without any run.
            if block
                .rows
                .iter()
                .all(|row| !none.cost(row.cost.unwrap_or(block.cost)))
            {
                let grid = Grid::build(page, block, &runs, none)?;
                let differences = grid.differences(&Grid::parse(inside));
                faults.extend(name_faults(page, block, differences));
            }
        }
        Ok(faults)
    }

    fn plot_faults(&self, name: &str, text: &str) -> Vec<String> {
        let folder = Path::new(name).parent().unwrap_or(Path::new(""));
        words::plots(text)
            .into_iter()
            .filter(|plot| {
                let path = folder.join(plot).to_string_lossy().into_owned();
                let made = self
                    .registry
                    .blocks()
                    .any(|(_, block)| block.pictures.iter().any(|p| p.file == path));
                let allowed = &self.registry.allow.plot;
                !made && !allowed.iter().any(|a| a.page == *name && a.text == *plot)
            })
            .map(|plot| format!("{name}: no command makes the plot {plot}"))
            .collect()
    }

    /// Runs commands and compares their figures with the pages.
    pub(crate) fn figure_faults(
        &self,
        wanted: &Wanted,
        workers: usize,
    ) -> Result<Vec<String>, String> {
        let select = Select {
            long: wanted.long || !wanted.names.is_empty(),
            times: false,
        };
        let mut runs = Runs::new(&self.program, &self.root)?;
        let (chosen, skipped) = self.possible(self.chosen(wanted)?);
        for name in skipped.iter().filter(|_| select.long) {
            eprintln!("{name}");
        }
        let mut all = BTreeSet::new();
        for (page, block) in &chosen {
            all.extend(grid::needed(page, block, select)?);
        }
        runs.run(all, workers)?;
        let mut faults = Vec::new();
        for (page, block) in chosen {
            let text = self.read(&page.page)?;
            let Some(range) = range_of(&text, &block.name) else {
                faults.push(format!("{}: has no block `{}`", page.page, block.name));
                continue;
            };
            let lines: Vec<&str> = text.lines().collect();
            match Grid::build(page, block, &runs, select) {
                Ok(grid) => {
                    let differences = grid.differences(&Grid::parse(&lines[range]));
                    faults.extend(name_faults(page, block, differences));
                }
                Err(error) => faults.push(error),
            }
            if select.cost(block.cost) {
                let differing = self.copy_pictures(page, block, &runs, select, false)?;
                faults.extend(differing);
            }
        }
        Ok(faults)
    }

    /// Remakes blocks, each as soon as its commands are done.
    pub(crate) fn write(&self, wanted: &Wanted) -> Result<Vec<String>, String> {
        let select = Select {
            long: wanted.long || !wanted.names.is_empty(),
            times: wanted.times,
        };
        let mut runs = Runs::new(&self.program, &self.root)?;
        let (chosen, mut faults) = self.possible(self.chosen(wanted)?);
        for (page, block) in chosen {
            if !select.cost(block.cost) {
                continue;
            }
            let load = page::load();
            let made = runs
                .run(grid::needed(page, block, select)?, 1)
                .and_then(|()| Grid::build(page, block, &runs, select));
            match made {
                Ok(grid) => {
                    faults.extend(self.copy_pictures(page, block, &runs, select, true)?);
                    self.replace(page, block, grid, select, &load)?;
                }
                Err(error) => faults.push(error),
            }
        }
        Ok(faults)
    }

    /// Those whose needs are met, and what the others lack.
    fn possible<'a>(
        &self,
        blocks: Vec<(&'a Page, &'a Block)>,
    ) -> (Vec<(&'a Page, &'a Block)>, Vec<String>) {
        let mut lacking = Vec::new();
        let mut possible = Vec::new();
        for (page, block) in blocks {
            let lacks = block.needs.iter().find(|need| match need.as_str() {
                "valgrind" => !has_valgrind(),
                _ => runs::meshes().is_none(),
            });
            match lacks {
                None => possible.push((page, block)),
                Some(need) => lacking.push(format!("{} is left: it needs {need}", block.name)),
            }
        }
        (possible, lacking)
    }

    fn replace(
        &self,
        page: &Page,
        block: &Block,
        mut grid: Grid,
        select: Select,
        load: &str,
    ) -> Result<(), String> {
        let text = self.read(&page.page)?;
        let range = range_of(&text, &block.name)
            .ok_or(format!("{}: has no block `{}`", page.page, block.name))?;
        let lines: Vec<&str> = text.lines().collect();
        let old = &lines[range.clone()];
        grid.keep(&Grid::parse(old));
        let mut new = String::new();
        if !block.columns.is_empty() {
            new += &grid.markdown();
            new.push('\n');
        }
        let shown: Vec<_> = block.pictures.iter().filter(|p| p.shown).collect();
        for picture in &shown {
            let path = relative(&page.page, &picture.file);
            new += &format!("![{}]({path})\n", picture.alt);
        }
        if !shown.is_empty() {
            new.push('\n');
        }
        let now = page::now(&self.root);
        let mut foot = format!("<sub>{} Figures: {now}.", page::how(page, block));
        if page::has_times(block) {
            let times = match page::times_of(old) {
                Some(times) if !select.times => times,
                _ => format!("of the same run, load {load}"),
            };
            foot += &format!(" Times: {times}.");
        }
        new += &page::wrap(&(foot + "</sub>"));
        let mut whole = lines[..range.start].join("\n");
        whole += &format!("\n{new}\n");
        whole += &lines[range.end..].join("\n");
        whole.push('\n');
        std::fs::write(self.root.join(&page.page), whole).map_err(|e| format!("{}: {e}", page.page))
    }

    /// Copies a block's pictures to their places, or tells which differ.
    fn copy_pictures(
        &self,
        page: &Page,
        block: &Block,
        runs: &Runs,
        select: Select,
        write: bool,
    ) -> Result<Vec<String>, String> {
        let mut differing = Vec::new();
        for picture in &block.pictures {
            if picture.kind != registry::Kind::Exact && !select.times {
                continue;
            }
            let run = block
                .runs
                .get(&picture.run)
                .ok_or(format!("{}: there is no run `{}`", block.name, picture.run))?;
            let run = Concrete::new(run, &page.vars, &page.prepare);
            runs.value(&run)?;
            let made = runs.file(&run, &picture.made).unwrap_or_default();
            let bytes = std::fs::read(&made).map_err(|e| format!("{}: {e}", made.display()))?;
            let place = self.root.join(&picture.file);
            if write {
                std::fs::write(&place, bytes).map_err(|e| format!("{}: {e}", picture.file))?;
            } else if std::fs::read(&place).ok().as_deref() != Some(&bytes) {
                differing.push(format!("{}: another picture is made now", picture.file));
            }
        }
        Ok(differing)
    }

    /// Every block, its page and its foot.
    pub(crate) fn list(&self) -> Result<String, String> {
        let mut texts = BTreeMap::new();
        let mut list = String::new();
        for (page, block) in self.registry.blocks() {
            if !texts.contains_key(&page.page) {
                texts.insert(page.page.clone(), self.read(&page.page)?);
            }
            let text = &texts[&page.page];
            let lines: Vec<&str> = text.lines().collect();
            let foot = range_of(text, &block.name)
                .map(|range| page::foot(&lines[range]))
                .unwrap_or_default();
            let figures = foot
                .split_once(" Figures: ")
                .map_or("no figures yet", |(_, f)| f);
            list += &format!(
                "{:24} {:32} {:5?} {}\n",
                block.name,
                page.page,
                block.cost,
                figures.trim_end_matches("</sub>")
            );
        }
        Ok(list)
    }
}

fn range_of(text: &str, name: &str) -> Option<std::ops::Range<usize>> {
    let blocks = page::blocks(text).ok()?;
    blocks
        .into_iter()
        .find(|(n, _)| n == name)
        .map(|(_, range)| range)
}

fn name_faults(page: &Page, block: &Block, faults: Vec<String>) -> Vec<String> {
    faults
        .into_iter()
        .map(|fault| format!("{}, {}: {fault}", page.page, block.name))
        .collect()
}

/// A path from a page to a file, both from the root.
fn relative(page: &str, file: &str) -> String {
    match page.rsplit_once('/') {
        Some((folder, _)) => match file.strip_prefix(&format!("{folder}/")) {
            Some(inside) => inside.to_owned(),
            None => format!("../{file}"),
        },
        None => file.to_owned(),
    }
}
