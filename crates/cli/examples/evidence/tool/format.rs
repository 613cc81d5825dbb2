//! How a figure is printed. `,` an integer with thousands; `.2` two decimals; `+.1` with its sign; `s3` three
//! significant digits; `,.1` both. What follows a space is put behind: `.1 %`. With braces the pattern is a sentence
//! and each brace a figure: `{.1} to {.1}`.

use shiftvox_lab::report::grouped;

use super::expression::Figure;

/// Prints figures by a pattern.
pub(crate) fn show(figures: &[Figure], pattern: &str) -> Result<String, String> {
    if !pattern.contains('{') {
        return match figures {
            [one] => one_figure(one, pattern),
            _ => Err(format!(
                "`{pattern}` prints one figure, not {}",
                figures.len()
            )),
        };
    }
    let mut text = String::new();
    let mut rest = pattern;
    let mut figures = figures.iter();
    while let Some((before, after)) = rest.split_once('{') {
        let (inner, behind) = after.split_once('}').ok_or("a } is missing")?;
        let figure = figures
            .next()
            .ok_or(format!("`{pattern}` has more braces than there are values"))?;
        text += before;
        text += &one_figure(figure, inner)?;
        rest = behind;
    }
    match figures.next() {
        None => Ok(text + rest),
        Some(_) => Err(format!(
            "`{pattern}` has fewer braces than there are values"
        )),
    }
}

fn one_figure(figure: &Figure, pattern: &str) -> Result<String, String> {
    let number = match figure {
        Figure::None => return Ok("-".to_owned()),
        Figure::Text(text) => return Ok(text.clone()),
        Figure::Number(number) => *number,
    };
    let (format, unit) = match pattern.split_once(' ') {
        Some((format, unit)) => (format, format!(" {unit}")),
        None => (pattern, String::new()),
    };
    let wrong = || format!("what is the pattern `{pattern}`?");
    let signed = format.starts_with('+');
    let format = format.trim_start_matches('+');
    let is_grouped = format.starts_with(',');
    let format = format.trim_start_matches(',');
    let decimals = if let Some(digits) = format.strip_prefix('s') {
        let digits: i32 = digits.parse().map_err(|_| wrong())?;
        let magnitude = if number == 0.0 {
            0
        } else {
            number.abs().log10().floor() as i32
        };
        (digits - 1 - magnitude).max(0) as usize
    } else if let Some(digits) = format.strip_prefix('.') {
        digits.parse().map_err(|_| wrong())?
    } else if format.is_empty() {
        0
    } else {
        return Err(wrong());
    };
    if !number.is_finite() {
        return Ok("-".to_owned());
    }
    let mut text = format!("{:.decimals$}", number.abs());
    if is_grouped {
        text = group(&text);
    }
    let zero = text.chars().all(|c| !c.is_ascii_digit() || c == '0');
    let sign = match (number < 0.0 && !zero, signed && !zero) {
        (true, _) => "-",
        (false, true) => "+",
        (false, false) => "",
    };
    Ok(format!("{sign}{text}{unit}"))
}

fn group(text: &str) -> String {
    let (whole, fraction) = text.split_at(text.find('.').unwrap_or(text.len()));
    let digits: Result<u128, _> = whole.parse();
    digits.map_or_else(|_| whole.to_owned(), grouped) + fraction
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns() {
        let one = |number: f64, pattern: &str| show(&[Figure::Number(number)], pattern);
        assert_eq!(one(1_152_638.0, ","), Ok("1,152,638".to_owned()));
        assert_eq!(one(999.6, ","), Ok("1,000".to_owned()));
        assert_eq!(one(1234.56, ",.1"), Ok("1,234.6".to_owned()));
        assert_eq!(one(-0.04, "+.1 %"), Ok("0.0 %".to_owned()));
        assert_eq!(one(3.12, "+.1 %"), Ok("+3.1 %".to_owned()));
        assert_eq!(one(13.97, "s3"), Ok("14.0".to_owned()));
        assert_eq!(one(0.02345, "s3"), Ok("0.0234".to_owned()));
        assert_eq!(one(1772.0, "s3"), Ok("1772".to_owned()));
        assert_eq!(show(&[Figure::None], ","), Ok("-".to_owned()));
        let two = [Figure::Number(1.0), Figure::Number(2.5)];
        assert_eq!(show(&two, "{,} of {.1} M"), Ok("1 of 2.5 M".to_owned()));
        assert!(show(&two, ",").is_err() && show(&two, "{,}").is_err());
        assert!(one(1.0, "x").is_err());
    }
}
