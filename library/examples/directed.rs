// Prints an interval that contains h(A,B), the largest distance of a point of A to B. Needs no crate:
//
//     rustc -O directed.rs -l hausbench
//     ./directed a.ply b.ply
use std::ffi::{c_char, c_void, CStr, CString};
use std::ptr::{null, null_mut};

// As in hausbench.h, whose macros HAUSBENCH_..._INIT give the initial values.
#[repr(C)]
struct Error {
    size: usize,
    code: i32,
    argument: i32,
    row: i64,
    text: [c_char; 1024],
}

#[repr(C)]
struct Answer {
    size: usize,
    status: i32,
    to_source: i32,
    lower: f64,
    upper: f64,
    source_point: [f64; 3],
    target_point: [f64; 3],
    source_row: i64,
    target_row: i64,
    prepare_seconds: f64,
    solve_seconds: f64,
}

extern "C" {
    fn hausbench_read(path: *const c_char, shape: *mut *mut c_void, error: *mut Error) -> i32;
    fn hausbench_prepare(
        source: *const c_void,
        target: *const c_void,
        plan: *const c_void,
        pair: *mut *mut c_void,
        error: *mut Error,
    ) -> i32;
    fn hausbench_directed(pair: *mut c_void, query: *const c_void, answer: *mut Answer, error: *mut Error) -> i32;
    fn hausbench_pair_release(pair: *mut c_void);
    fn hausbench_shape_release(shape: *mut c_void);
}

// Calls a function of the library, and turns its error into a text.
fn call(function: impl FnOnce(*mut Error) -> i32) -> Result<(), String> {
    let mut error = Error { size: std::mem::size_of::<Error>(), code: 0, argument: 0, row: -1, text: [0; 1024] };
    match function(&mut error) {
        0 => Ok(()),
        _ => Err(unsafe { CStr::from_ptr(error.text.as_ptr()) }.to_string_lossy().into_owned()),
    }
}

struct Shape(*mut c_void);

impl Shape {
    fn read(path: &str) -> Result<Shape, String> {
        let name = CString::new(path).map_err(|_| format!("{path:?}: has a NUL character"))?;
        let mut shape = null_mut();
        call(|error| unsafe { hausbench_read(name.as_ptr(), &mut shape, error) })?;
        Ok(Shape(shape))
    }
}

impl Drop for Shape {
    fn drop(&mut self) {
        unsafe { hausbench_shape_release(self.0) }
    }
}

fn directed(a: &Shape, b: &Shape) -> Result<Answer, String> {
    let mut pair = null_mut();
    call(|error| unsafe { hausbench_prepare(a.0, b.0, null(), &mut pair, error) })?;
    let mut answer: Answer = unsafe { std::mem::zeroed() };
    answer.size = std::mem::size_of::<Answer>();
    let found = call(|error| unsafe { hausbench_directed(pair, null(), &mut answer, error) });
    unsafe { hausbench_pair_release(pair) };
    found.map(|()| answer)
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    if arguments.len() != 3 {
        eprintln!("usage: directed A B");
        std::process::exit(2);
    }
    let answer = Shape::read(&arguments[1]).and_then(|a| directed(&a, &Shape::read(&arguments[2])?));
    match answer {
        Ok(answer) => println!("h(A,B) in [{:?}, {:?}]", answer.lower, answer.upper),
        Err(text) => {
            eprintln!("{text}");
            std::process::exit(2);
        }
    }
}
