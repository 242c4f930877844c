//! What a scene took: the line after each picture, and `--stats`.

use std::{fmt::Write as _, time::Duration};

use serde_json::json;

use crate::render::{Image, RenderStats};

/// Time of each stage of one scene.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Stages {
    /// Reading the scene and the files it names.
    pub(super) read: Duration,
    /// Running the script, or importing the course scene.
    pub(super) script: Duration,
    /// Building acceleration structures.
    pub(super) compile: Duration,
    /// Tracing rays.
    pub(super) trace: Duration,
    /// Encoding and writing pictures.
    pub(super) write: Duration,
    /// Everything, from the start of reading to the end of writing.
    pub(super) total: Duration,
}

/// All that `--stats` tells about one scene.
#[derive(Clone, Debug)]
pub(super) struct Stats {
    /// The scene's name.
    pub(super) scene: String,
    /// Where the last picture went; empty where it went nowhere.
    pub(super) output: String,
    /// Hash of the last picture.
    pub(super) hash: String,
    /// Width and height of the last picture in pixels.
    pub(super) size: (u32, u32),
    /// Pictures rendered.
    pub(super) pictures: usize,
    /// Threads rendered with.
    pub(super) threads: usize,
    /// Sums over all pictures.
    pub(super) render: RenderStats,
    /// Time of each stage.
    pub(super) stages: Stages,
    /// Most memory the process ever had, in bytes, where the system tells.
    pub(super) peak_memory: Option<u64>,
}

/// Sums of what several pictures took; the sizes are the largest.
pub(super) fn sum<'a>(all: impl IntoIterator<Item = &'a RenderStats>) -> RenderStats {
    let mut sum = RenderStats::default();
    for s in all {
        sum.camera_rays += s.camera_rays;
        sum.shadow_rays += s.shadow_rays;
        sum.reflected_rays += s.reflected_rays;
        sum.refracted_rays += s.refracted_rays;
        sum.invalid_samples += s.invalid_samples;
        sum.primitives = sum.primitives.max(s.primitives);
        sum.world_bytes = sum.world_bytes.max(s.world_bytes);
        sum.compile += s.compile;
        sum.trace += s.trace;
    }
    sum
}

/// `scene.png  640x480  1.23 s  4.50 Mrays/s  HASH`
pub(super) fn picture_line(path: &str, image: &Image, took: Duration, stats: &RenderStats) -> String {
    format!(
        "{path}  {}x{}  {}  {}  {}",
        image.width(),
        image.height(),
        time(took),
        rate(stats.rays(), stats.trace),
        image.hash()
    )
}

impl Stats {
    /// Camera rays of a pixel, in the mean over all pixels of all pictures, where those have the size of the last.
    fn samples(&self) -> f64 {
        let pixels = u64::from(self.size.0) * u64::from(self.size.1) * self.pictures.max(1) as u64;
        self.render.camera_rays as f64 / pixels.max(1) as f64
    }

    /// A table for people.
    pub(super) fn text(&self) -> String {
        let r = &self.render;
        let s = &self.stages;
        let seconds = |d: Duration| format!("{:.3} s", d.as_secs_f64());
        let mebibytes = |bytes: u64| format!("{:.1} MiB", bytes as f64 / 1_048_576.0);
        let mut rows = vec![
            ("rays", r.rays().to_string()),
            ("  camera", r.camera_rays.to_string()),
            ("  per pixel", format!("{:.2}", self.samples())),
            ("  shadow", r.shadow_rays.to_string()),
            ("  reflected", r.reflected_rays.to_string()),
            ("  refracted", r.refracted_rays.to_string()),
            ("rays per second", rate(r.rays(), s.trace)),
            ("primitives", r.primitives.to_string()),
            ("pictures", self.pictures.to_string()),
            ("threads", self.threads.to_string()),
            ("time", seconds(s.total)),
            ("  read", seconds(s.read)),
            ("  script", seconds(s.script)),
            ("  compile", seconds(s.compile)),
            ("  trace", seconds(s.trace)),
            ("  write", seconds(s.write)),
            ("compiled scene", mebibytes(r.world_bytes)),
        ];
        rows.extend(self.peak_memory.map(|bytes| ("peak memory", mebibytes(bytes))));
        if r.invalid_samples > 0 {
            rows.push(("invalid samples", r.invalid_samples.to_string()));
        }
        let mut text = self.scene.clone();
        for (name, value) in rows {
            let _ = write!(text, "\n  {name:<17} {value:>16}");
        }
        text
    }

    /// One line of JSON.
    pub(super) fn json(&self) -> String {
        let r = &self.render;
        let s = &self.stages;
        let seconds = |d: Duration| format!("{:.6}", d.as_secs_f64());
        format!(
            concat!(
                r#"{{"scene":{},"output":{},"hash":{},"width":{},"height":{},"pictures":{},"threads":{},"#,
                r#""rays":{{"camera":{},"camera_per_pixel":{:.4},"shadow":{},"reflected":{},"refracted":{},"total":{}}},"#,
                r#""seconds":{{"read":{},"script":{},"compile":{},"trace":{},"write":{},"total":{}}},"#,
                r#""rays_per_second":{:.0},"primitives":{},"invalid_samples":{},"world_bytes":{},"#,
                r#""peak_memory_bytes":{}}}"#
            ),
            json!(self.scene),
            json!(self.output),
            json!(self.hash),
            self.size.0,
            self.size.1,
            self.pictures,
            self.threads,
            r.camera_rays,
            self.samples(),
            r.shadow_rays,
            r.reflected_rays,
            r.refracted_rays,
            r.rays(),
            seconds(s.read),
            seconds(s.script),
            seconds(s.compile),
            seconds(s.trace),
            seconds(s.write),
            seconds(s.total),
            per_second(r.rays(), s.trace),
            r.primitives,
            r.invalid_samples,
            r.world_bytes,
            self.peak_memory
                .map_or("null".to_owned(), |bytes| bytes.to_string()),
        )
    }
}

/// Most memory this process ever had, in bytes; `None` where the system does not tell (not Linux).
pub(super) fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}

/// `1 picture`, `12 pictures`.
pub(super) fn pictures(count: usize) -> String {
    match count {
        1 => "1 picture".to_owned(),
        n => format!("{n} pictures"),
    }
}

fn per_second(count: u64, time: Duration) -> f64 {
    let seconds = time.as_secs_f64();
    if seconds > 0.0 {
        count as f64 / seconds
    } else {
        0.0
    }
}

/// Rays per second with three figures.
pub(super) fn rate(rays: u64, time: Duration) -> String {
    let rate = per_second(rays, time);
    let (value, unit) = match rate {
        r if r >= 1e9 => (r / 1e9, "Grays/s"),
        r if r >= 1e6 => (r / 1e6, "Mrays/s"),
        r if r >= 1e3 => (r / 1e3, "krays/s"),
        r => return format!("{r:.0} rays/s"),
    };
    let decimals = if value >= 100.0 {
        0
    } else if value >= 10.0 {
        1
    } else {
        2
    };
    format!("{value:.decimals$} {unit}")
}

/// A duration as people say it.
pub(super) fn time(duration: Duration) -> String {
    let seconds = duration.as_secs();
    match seconds {
        0..10 => format!("{:.2} s", duration.as_secs_f64()),
        10..120 => format!("{seconds} s"),
        120..7200 => format!("{} min {:02} s", seconds / 60, seconds % 60),
        _ => format!("{} h {:02} min", seconds / 3600, seconds / 60 % 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_and_rates_are_short() {
        let times = [0.004, 1.234, 9.999, 42.9, 125.0, 7260.0].map(|s| time(Duration::from_secs_f64(s)));
        assert_eq!(
            times,
            ["0.00 s", "1.23 s", "10.00 s", "42 s", "2 min 05 s", "2 h 01 min"]
        );
        let rates =
            [0, 999, 1_234, 45_600, 4_500_000, 7_890_000_000].map(|n| rate(n, Duration::from_secs(1)));
        assert_eq!(
            rates,
            [
                "0 rays/s",
                "999 rays/s",
                "1.23 krays/s",
                "45.6 krays/s",
                "4.50 Mrays/s",
                "7.89 Grays/s"
            ]
        );
        assert_eq!(rate(5, Duration::ZERO), "0 rays/s");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn memory_is_known() {
        assert!(peak_memory().is_some_and(|bytes| bytes > 1 << 20));
    }
}
