//! The sRGB transfer function (IEC 61966-2-1), for values from 0 to 1.

pub fn to_linear(value: f64) -> f64 {
    if value <= 0.040_45 {
        value / 12.92
    } else {
        libm::pow((value + 0.055) / 1.055, 2.4)
    }
}
