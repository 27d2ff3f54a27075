//! The graphics card: one adapter, opened once, tried out before it is trusted. The stages are the files
//! of `shaders/`, in this order:
//!
//! ```text
//! shade ─► share ─► degrees ─► begin ─► step, count ─► … ─► kept, count
//! ```
//!
//! What is seen without the walls that move comes from the cores' sweep, as rows of tiles. `shade` leaves of it what the
//! walls of a layout leave, so that a layout costs its walls alone to send. `step` walks from 32 roots a word as the waves of
//! the cores do. All integers are those of the cores.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use wgpu::{
    AdapterInfo, BindGroup, BindGroupEntry, BindGroupLayout, BindGroupLayoutEntry, BindingResource,
    BindingType, Buffer, BufferBinding, BufferBindingType, BufferDescriptor, BufferUsages,
    CommandEncoderDescriptor, ComputePassDescriptor, ComputePipeline, Device, DeviceType, Limits, Queue,
    ShaderStages,
};

pub use crate::refusal::Refusal;

use crate::geometry::Segment;

use super::forest::tally;
use super::visibility::visibility_graph_serial;
use super::{Lattice, Obstacles};

pub mod forest;
mod rows;
mod shape;
mod store;
#[cfg(test)]
mod tests;
mod walk;

use forest::CardForest;

/// Loop iterations of one invocation, all its loops together, at most, on adapters in software: Mesa's stops loops
/// silently at 65,535.
pub const LOOP_ITERATIONS_MAX: u32 = 60_000;

/// Walls one invocation compares: each once as a whole, with up to 64 cells, and with these again where that is not sure.
pub(super) const SEGMENTS_PER_PASS: u32 = LOOP_ITERATIONS_MAX / 129;

/// Invocations of a workgroup; the shaders say the same.
pub(super) const GROUP: u32 = 64;

/// Invocations along the first axis of a dispatch, at most; `LINE` in `shaders/params.wgsl`. The others are along the
/// third.
const LINE: u64 = 1 << 21;

/// Dispatches of one submission, at most.
const STEPS_PER_SUBMISSION: usize = 1024;

/// Bytes between the parameters of two dispatches: the alignment every adapter can do.
const PARAMS_STRIDE: usize = 256;

/// Parameters of a dispatch; `Params` in `shaders/params.wgsl`, in the same order.
#[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(super) struct Params {
    pub vertices: u32,
    pub tiles: u32,
    pub layouts: u32,
    pub first_tile: u32,
    pub block_tiles: u32,
    pub squares: u32,
    pub squares_at: u32,
    pub roots: u32,
    pub first_root: u32,
    pub all_roots: u32,
    pub words: u32,
    pub level: u32,
    pub first_square: u32,
    pub pass_squares: u32,
    pub is_last: u32,
    pub slot: u32,
    pub first_segment: u32,
    pub segments: u32,
    pub spacing: u32,
}

/// Workgroups of a dispatch of so many invocations for each layout.
pub(super) fn groups(invocations: u64, layouts: u32) -> [u32; 3] {
    let along = invocations.min(LINE).div_ceil(u64::from(GROUP)) as u32;
    [along, layouts, invocations.div_ceil(LINE) as u32]
}

/// One stage: its shader, and which of its buffers (from binding 1) it writes.
pub(super) struct Stage {
    pipeline: ComputePipeline,
    layout: BindGroupLayout,
}

const PARAMS_WGSL: &str = include_str!("../../../shaders/params.wgsl");

/// Name, source and, for bindings 1.., whether the stage writes them.
const STAGES: [(&str, &str, &[bool]); 7] = [
    ("shade", include_str!("../../../shaders/shade.wgsl"), &[false, false, false, false, false, false, true]),
    ("share", include_str!("../../../shaders/share.wgsl"), &[false, false, true]),
    ("degrees", include_str!("../../../shaders/degrees.wgsl"), &[false, false, false, false, false, true]),
    ("begin", include_str!("../../../shaders/begin.wgsl"), &[false, false, false, true, true, true, true]),
    (
        "step",
        include_str!("../../../shaders/step.wgsl"),
        &[false, false, false, true, false, true, true, true],
    ),
    ("count", include_str!("../../../shaders/count.wgsl"), &[false, false, true]),
    ("kept", include_str!("../../../shaders/kept.wgsl"), &[false, false, false, false, true, true]),
];

/// What is recorded before it is submitted.
pub(super) enum Step<'a> {
    Run { stage: &'a Stage, buffers: BindGroup, params: Params, groups: [u32; 3] },
    Clear { buffer: &'a Buffer, from: u64, bytes: u64 },
    Copy { from: &'a Buffer, at: u64, to: &'a Buffer, to_at: u64, bytes: u64 },
}

/// An adapter that computes what the cores compute.
pub struct Gpu {
    device: Device,
    queue: Queue,
    pub(super) shade: Stage,
    pub(super) share: Stage,
    pub(super) degrees: Stage,
    pub(super) begin: Stage,
    pub(super) step: Stage,
    pub(super) count: Stage,
    pub(super) kept: Stage,
    params: Buffer,
    /// Held while the parameters are written and read by a submission: they have one buffer.
    turn: Mutex<()>,
    name: String,
    is_software: bool,
    limits: Limits,
    trouble: Arc<Mutex<Option<String>>>,
}

impl Gpu {
    /// The machine's graphics card, or with `software` whatever adapter there is; opened and tried out
    /// once in the life of the process.
    ///
    /// # Errors
    /// Why there is none, in words for the report.
    pub fn shared(software: bool) -> Result<Arc<Self>, Refusal> {
        static CARD: OnceLock<Result<Arc<Gpu>, Refusal>> = OnceLock::new();
        static ANY: OnceLock<Result<Arc<Gpu>, Refusal>> = OnceLock::new();
        let card = || CARD.get_or_init(|| Self::open(false));
        if !software {
            return card().clone();
        }
        ANY.get_or_init(|| card().clone().or_else(|_| Self::open(true))).clone()
    }

    /// Opens an adapter and tries it out; with `software` only one that computes on the cores.
    fn open(software: bool) -> Result<Arc<Self>, Refusal> {
        if !software && !may_have_card() {
            return Err(Refusal::Absent("this machine has no graphics card".into()));
        }
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let backends = wgpu::Backends::VULKAN | wgpu::Backends::METAL | wgpu::Backends::DX12;
        let mut adapters = pollster::block_on(instance.enumerate_adapters(backends));
        adapters.retain(|a| is_software(&a.get_info()) == software);
        // Cards of their own before those that share the cores' memory.
        adapters.sort_by_key(|a| a.get_info().device_type != DeviceType::DiscreteGpu);
        let Some(adapter) = adapters.first() else {
            let what = if software { "adapter, not even one in software" } else { "graphics card" };
            return Err(Refusal::Absent(format!("no {what} was found")));
        };
        let info = adapter.get_info();
        let limits = adapter.limits();
        let descriptor = wgpu::DeviceDescriptor {
            required_limits: limits.clone(),
            memory_hints: wgpu::MemoryHints::Performance,
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|e| Refusal::Failed(format!("{} could not be opened: {e}", info.name)))?;
        let new = Self::new(device, queue, limits, &info);
        let new = Arc::new(new);
        new.check().and_then(|()| self_test(&new)).map_err(Refusal::Failed)?;
        Ok(new)
    }

    fn new(device: Device, queue: Queue, limits: Limits, info: &AdapterInfo) -> Self {
        let trouble = Arc::new(Mutex::new(None));
        let told = Arc::clone(&trouble);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            told.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error.to_string());
        }));
        let params = device.create_buffer(&BufferDescriptor {
            label: Some("params"),
            size: (STEPS_PER_SUBMISSION * PARAMS_STRIDE) as u64,
            usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let [shade, share, degrees, begin, step, count, kept] =
            STAGES.map(|(n, s, w)| stage(&device, n, s, w));
        let name = if info.driver_info.is_empty() {
            format!("{} ({:?})", info.name, info.backend)
        } else {
            format!("{} ({:?}, {})", info.name, info.backend, info.driver_info)
        };
        let is_software = is_software(info);
        Self {
            device,
            queue,
            shade,
            share,
            degrees,
            begin,
            step,
            count,
            kept,
            params,
            turn: Mutex::new(()),
            name,
            is_software,
            limits,
            trouble,
        }
    }

    /// Name of the adapter, with its driver.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether the adapter computes on the cores: exact, but no faster than they are.
    pub fn is_software(&self) -> bool {
        self.is_software
    }

    /// Bytes that one buffer may have.
    pub(super) fn buffer_bytes_max(&self) -> u64 {
        let limit = self.limits.max_storage_buffer_binding_size.min(self.limits.max_buffer_size);
        // Words are counted in 32 bits.
        limit.min(1 << 33)
    }

    /// Loop iterations that one invocation may have.
    pub(super) fn iterations_max(&self) -> u64 {
        if self.is_software { LOOP_ITERATIONS_MAX.into() } else { u64::MAX }
    }

    /// A buffer of at least `words` words.
    pub(super) fn buffer(&self, words: u64) -> Buffer {
        self.buffer_for(words, BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST)
    }

    /// A buffer that comes back.
    pub(super) fn staging(&self, words: u64) -> Buffer {
        self.buffer_for(words, BufferUsages::MAP_READ | BufferUsages::COPY_DST)
    }

    fn buffer_for(&self, words: u64, usage: BufferUsages) -> Buffer {
        let size = words.max(4) * 4;
        self.device.create_buffer(&BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
    }

    pub(super) fn write<T: bytemuck::NoUninit>(&self, buffer: &Buffer, values: &[T]) {
        if !values.is_empty() {
            self.queue.write_buffer(buffer, 0, bytemuck::cast_slice(values));
        }
    }

    /// The buffers of a stage, from binding 1.
    pub(super) fn bind(&self, stage: &Stage, buffers: &[&Buffer]) -> BindGroup {
        let params = BufferBinding {
            buffer: &self.params,
            offset: 0,
            size: std::num::NonZeroU64::new(size_of::<Params>() as u64),
        };
        let first = BindGroupEntry { binding: 0, resource: BindingResource::Buffer(params) };
        let others = (1..)
            .zip(buffers)
            .map(|(binding, b)| BindGroupEntry { binding, resource: b.as_entire_binding() });
        self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &stage.layout,
            entries: &std::iter::once(first).chain(others).collect::<Vec<_>>(),
        })
    }

    /// Hands steps to the adapter, in order; a list that fits goes in one submission.
    pub(super) fn submit(&self, steps: &[Step<'_>]) -> Result<(), String> {
        let _turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
        for steps in steps.chunks(STEPS_PER_SUBMISSION) {
            let mut bytes = vec![0u8; steps.len() * PARAMS_STRIDE];
            let mut encoder = self.device.create_command_encoder(&CommandEncoderDescriptor::default());
            for (i, step) in steps.iter().enumerate() {
                if let Step::Run { params, .. } = step {
                    bytes[i * PARAMS_STRIDE..][..size_of::<Params>()]
                        .copy_from_slice(bytemuck::bytes_of(params));
                }
                record(&mut encoder, step, (i * PARAMS_STRIDE) as u32);
            }
            self.queue.write_buffer(&self.params, 0, &bytes);
            self.queue.submit([encoder.finish()]);
        }
        self.check()
    }

    /// Waits for the adapter and reads the first `words` words of a staging buffer.
    pub(super) fn read(&self, staging: &Buffer, words: usize) -> Result<Vec<u32>, String> {
        let slice = staging.slice(..(words * 4) as u64);
        let (tell, told) = std::sync::mpsc::channel();
        slice.map_async(wgpu::MapMode::Read, move |result| {
            let _ = tell.send(result);
        });
        let waited = self.device.poll(wgpu::PollType::wait_indefinitely());
        self.check()?;
        waited.map_err(|e| format!("{} stopped answering: {e}", self.name))?;
        let mapped = told.recv().map_err(|e| e.to_string())?;
        mapped.map_err(|e| format!("{} returned nothing: {e}", self.name))?;
        let view = slice.get_mapped_range().map_err(|e| format!("{} returned nothing: {e}", self.name))?;
        let values = bytemuck::pod_collect_to_vec(&view);
        drop(view);
        staging.unmap();
        Ok(values)
    }

    fn check(&self) -> Result<(), String> {
        let trouble = self.trouble.lock().unwrap_or_else(PoisonError::into_inner);
        trouble.as_ref().map_or(Ok(()), |why| Err(format!("{}: {why}", self.name)))
    }
}

fn is_software(info: &AdapterInfo) -> bool {
    info.device_type == DeviceType::Cpu
}

/// Whether it is worth asking for a graphics card: asking loads every driver, software ones included.
fn may_have_card() -> bool {
    let nodes = ["/dev/dri", "/dev/nvidiactl", "/dev/dxg"];
    !cfg!(target_os = "linux") || nodes.iter().any(|node| std::path::Path::new(node).exists())
}

fn record(encoder: &mut wgpu::CommandEncoder, step: &Step<'_>, params_at: u32) {
    match step {
        Step::Run { stage, buffers, groups: [x, y, z], .. } => {
            let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor::default());
            pass.set_pipeline(&stage.pipeline);
            pass.set_bind_group(0, buffers, &[params_at]);
            pass.dispatch_workgroups(*x, *y, *z);
        }
        Step::Clear { buffer, from, bytes } => encoder.clear_buffer(buffer, *from, Some(*bytes)),
        Step::Copy { from, at, to, to_at, bytes } => {
            encoder.copy_buffer_to_buffer(from, *at, to, *to_at, *bytes);
        }
    }
}

fn stage(device: &Device, name: &str, source: &str, writes: &[bool]) -> Stage {
    let entry = |binding: u32, ty, has_dynamic_offset| BindGroupLayoutEntry {
        binding,
        visibility: ShaderStages::COMPUTE,
        ty: BindingType::Buffer { ty, has_dynamic_offset, min_binding_size: None },
        count: None,
    };
    let mut entries = vec![entry(0, BufferBindingType::Uniform, true)];
    entries.extend(
        (1..)
            .zip(writes)
            .map(|(i, writes)| entry(i, BufferBindingType::Storage { read_only: !writes }, false)),
    );
    let label = Some(name);
    let layout =
        device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label, entries: &entries });
    let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label,
        bind_group_layouts: &[Some(&layout)],
        immediate_size: 0,
    });
    let source = wgpu::ShaderSource::Wgsl(format!("{PARAMS_WGSL}\n{source}").into());
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label, source });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label,
        layout: Some(&pipeline_layout),
        module: &module,
        entry_point: Some("main"),
        compilation_options: Default::default(),
        cache: None,
    });
    Stage { pipeline, layout }
}

/// Cells a side, spacing and walls of the start-up test: every invocation runs into its limit, and twice
/// it in all, before it meets the walls that decide.
const TEST_SIDE: i32 = 9;
const TEST_SPACING_UM: i64 = 1_000_000;
pub(super) const TEST_SEGMENTS: u32 = 2 * SEGMENTS_PER_PASS + 40;

/// Compares a plan, above what an adapter may stop at, with the cores.
fn self_test(gpu: &Arc<Gpu>) -> Result<(), String> {
    let (lattice, obstacles) = test_plan();
    let expected = tally(&lattice, &visibility_graph_serial(&lattice, &obstacles), None);
    let unmoved = visibility_graph_serial(&lattice, &Obstacles::default());
    let forest = CardForest::new(Arc::clone(gpu), lattice, &unmoved, None, 1)?;
    let found = forest.tallies(&[obstacles])?;
    if found != [expected] {
        return Err(format!("{} computes wrong results: it failed the test at the start", gpu.name));
    }
    Ok(())
}

/// Specks between the lines of sight, in the middle of the plan, then walls that divide it.
pub(super) fn test_plan() -> (Arc<Lattice>, Obstacles) {
    let cells: Vec<[i32; 2]> = (0..TEST_SIDE).flat_map(|c| (0..TEST_SIDE).map(move |r| [c, r])).collect();
    let n = cells.len() as u32;
    let lattice = Lattice {
        spacing_um: TEST_SPACING_UM,
        origin_um: [17, -5],
        query: (0..n).collect(),
        is_reference: (0..n).map(|v| v % 3 != 0).collect(),
        beyond: None,
        cells,
    };
    let middle = i64::from(TEST_SIDE / 2) * TEST_SPACING_UM;
    let speck = |i: i64| {
        let at = [middle + 31_250 + i, middle + 15_625 - i % 7];
        Segment { a: at, b: [at[0] + 1, at[1]] }
    };
    let mut segments: Vec<Segment> = (0..i64::from(TEST_SEGMENTS) - 3).map(speck).collect();
    let half = TEST_SPACING_UM / 2;
    segments.extend([
        Segment { a: [middle + half, -half], b: [middle + half, 3 * TEST_SPACING_UM] },
        Segment { a: [middle + half, 4 * TEST_SPACING_UM], b: [middle + half, 20 * TEST_SPACING_UM] },
        Segment { a: [-half, 2 * TEST_SPACING_UM], b: [middle - half, 6 * TEST_SPACING_UM] },
    ]);
    (Arc::new(lattice), Obstacles { segments, blind: vec![7] })
}
