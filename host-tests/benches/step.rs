//! Time of one step of the paper's model and of a run of 90 steps, textbook against ours:
//! `cargo bench -p host-tests --bench step`.

mod drive;

use criterion::{Criterion, criterion_group, criterion_main};
use drive::{Drive, RUN};
use std::hint::black_box;

fn steps(criterion: &mut Criterion) {
    let drive = Drive::of_reference();
    for (name, steps) in [("one step", 1), ("run of 90 steps", RUN)] {
        let mut group = criterion.benchmark_group(name);
        group.bench_function("rundown", |bencher| bencher.iter(|| drive.ours(black_box(steps))));
        group.bench_function("textbook", |bencher| bencher.iter(|| drive.textbook(black_box(steps))));
        group.finish();
    }
}

criterion_group!(benches, steps);
criterion_main!(benches);
