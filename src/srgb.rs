//! The sRGB transfer function and its inverse (IEC 61966-2-1), for values from 0 to 1.

pub fn to_linear(value: f64) -> f64 {
    if value <= 0.040_45 {
        value / 12.92
    } else {
        libm::pow((value + 0.055) / 1.055, 2.4)
    }
}

pub fn from_linear(light: f64) -> f64 {
    if light <= 0.003_130_8 {
        12.92 * light
    } else {
        1.055 * libm::pow(light, 1.0 / 2.4) - 0.055
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn each_undoes_the_other() {
        for value in (0..=255).map(|byte| f64::from(byte) / 255.0) {
            let back = super::from_linear(super::to_linear(value));
            assert!((back - value).abs() < 1e-7, "{value}");
        }
    }
}
