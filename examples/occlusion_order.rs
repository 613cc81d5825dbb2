//! A property test of the order in which children are visited: for every eye, a child never hides one before it.

use shiftvox::OCCLUSION_ORDER;

fn main() {
    let mut checked = 0;
    // Eyes around a node whose centre is the origin: on each side of each plane through it.
    for eye in 0..8u8 {
        // The octant that the eye is in, exclusive-or with the order of octant 0.
        let order = OCCLUSION_ORDER.map(|child| child ^ (7 ^ eye));
        for (place, &first) in order.iter().enumerate() {
            for &later in &order[place + 1..] {
                // `later` hides `first` if it lies on the eye's side of a plane that parts them, for all such planes.
                let parting = first ^ later;
                let hides = (later ^ eye) & parting == 0;
                assert!(
                    !hides,
                    "from octant {eye}, {later} hides {first} and comes after it"
                );
                checked += 1;
            }
        }
    }
    println!("{checked} pairs, none out of order");
}
