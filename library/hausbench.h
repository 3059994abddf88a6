/* Certified distances between triangle meshes and point sets, for C99 and every language that can call C.

   h(A,B) is the largest distance of a point of A to B, and H(A,B) the larger of h(A,B) and h(B,A). Every answer is an
   interval that contains the exact value, rounding errors included.

       hausbench_shape *a, *b;
       hausbench_pair *pair;
       hausbench_answer answer = HAUSBENCH_ANSWER_INIT;
       hausbench_error error = HAUSBENCH_ERROR_INIT;
       if (hausbench_read("a.ply", &a, &error)) ...         every function returns HAUSBENCH_OK, which is 0, or a code
       ...
       hausbench_prepare(a, b, NULL, &pair, &error);
       hausbench_directed(pair, NULL, &answer, &error);     answer.bounds.lower <= h(A,B) <= answer.bounds.upper

   docs/c.md shows programs in C, C++ and Rust, and hausbench.hpp is this interface for C++. `make build` leaves the
   library in build/release/library, and `cmake --install build/release` installs it with files for CMake and
   pkg-config. Without installing it:

       cc program.c -Ilibrary -Lbuild/release/library -lhausbench -Wl,-rpath,$PWD/build/release/library

   Lengths are in the unit of the input. A *row* is a point or a triangle, as given; rows are numbered from 0.

   Errors: if a function fails, it returns a code, describes the error in *error unless that is NULL, and changes no
   other output.

   Structs: initialise every struct with its macro, which sets `size`. A later version may append members; the library
   reads and writes only the first `size` bytes. NULL for an optional struct means its initial values.

   Threads: any function may be called from any thread, and several threads may use one shape or pair at the same time,
   but not one chain. The library has no state of its own: it installs no signal handler, starts no process, and writes
   nothing to the terminal. It computes in the default floating-point environment, whatever the caller's is, and gives
   the caller's back. */
#ifndef HAUSBENCH_H
#define HAUSBENCH_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>

#if defined(HAUSBENCH_BUILDING)
#define HAUSBENCH_API __attribute__((visibility("default")))
#else
#define HAUSBENCH_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* The first is 1. It grows when a function or struct changes in a way that old callers cannot bear; the name of the
   shared library then changes, too. */
#define HAUSBENCH_INTERFACE 1

/* --- errors ------------------------------------------------------------------------------------------------------ */

enum {
    HAUSBENCH_OK = 0,
    HAUSBENCH_BAD_INPUT = 1, /* an argument, array or file is wrong; the text names it and says what to do */
    HAUSBENCH_NO_MEMORY = 2,
    HAUSBENCH_INTERNAL = 3 /* an error of the library: please report the text */
};

typedef struct hausbench_error {
    size_t size;
    int32_t code;
    int32_t argument; /* which argument of the function is wrong, from 1; 0: unknown */
    int64_t row;      /* the row of the array that is wrong; -1: none in particular */
    char text[1024];  /* one line in UTF-8, without a line break at its end */
} hausbench_error;
#define HAUSBENCH_ERROR_INIT                     \
    {                                            \
        sizeof(hausbench_error), 0, 0, -1, { 0 } \
    }

/* --- shapes ------------------------------------------------------------------------------------------------------ */

/* A triangle mesh or a point set. It never changes; structures that are built over it are kept with it and shared by
   all pairs that it belongs to. */
typedef struct hausbench_shape hausbench_shape;

enum { HAUSBENCH_FLOAT64 = 0, HAUSBENCH_FLOAT32 = 1, HAUSBENCH_INT64 = 2, HAUSBENCH_INT32 = 3 };

/* A table of `rows` times 3 numbers. Number k of row i is at data + i * row_stride + k * column_stride, in bytes;
   strides may be negative. */
typedef struct hausbench_array {
    const void* data;
    int64_t rows;
    int64_t row_stride;
    int64_t column_stride;
    int32_t type;     /* vertices: FLOAT64 or FLOAT32; faces: INT64 or INT32; in the byte order of the machine */
    int32_t reserved; /* 0 */
} hausbench_array;

/* Makes a mesh, or a point set if `faces` is NULL. Copies the arrays. Vertices that no face uses are not part of the
   mesh. Faces may be degenerate or duplicate. Fails with BAD_INPUT for no rows, more than 2^31 - 1 of them, a
   coordinate that is not finite, and an index that is negative or too large. O(rows). */
HAUSBENCH_API int hausbench_shape_of(const hausbench_array* vertices, const hausbench_array* faces,
                                     hausbench_shape** shape, hausbench_error* error);

/* Reads a file of one of the formats in docs/formats.md whose reader is ours, gzipped or not. The coordinates are the
   numbers that the file defines. A file without faces becomes a point set. Polygons are split into triangles, line
   segments of a mesh become degenerate triangles, and vertices that no face uses are dropped. */
HAUSBENCH_API int hausbench_read(const char* path, hausbench_shape** shape, hausbench_error* error);

typedef struct hausbench_read_options {
    size_t size;
    const char* format;  /* "obj", ...: the format; NULL: the ending of the file counts */
    const char* columns; /* of a text file of points: "2,3,4" or the names of the columns of x, y and z; NULL: by their
                             header */
    const char* unit;    /* NULL: the numbers count. "mm", "inch", ...: multiplies the coordinates by (the unit that the
                             file states / this unit), and rounds; a file that states no unit counts as being in this
                             one. "none": the numbers count, and the shape states no unit */
    const char* up;      /* NULL: the numbers count. "X", "Y" or "Z": turns the shape so that this axis points up; a
                             file that states no axes counts as having these. "none": the numbers count, and the shape
                             states no axes */
    int32_t drop_invalid; /* 1: drops points with a coordinate that is not finite, and faces that use them */
    int32_t reserved;     /* 0 */
} hausbench_read_options;
#define HAUSBENCH_READ_OPTIONS_INIT \
    { sizeof(hausbench_read_options), NULL, NULL, NULL, NULL, 0, 0 }

/* As hausbench_read, with options. */
HAUSBENCH_API int hausbench_read_with(const char* path, const hausbench_read_options* options, hausbench_shape** shape,
                                      hausbench_error* error);

typedef struct hausbench_description {
    size_t size;
    int32_t is_mesh; /* 1: a mesh, 0: a point set */
    int32_t reserved;
    int64_t vertices; /* number of rows, with those that no face uses */
    int64_t faces;    /* 0 for a point set */
    double box[6];    /* smallest x, y, z, largest x, y, z of the shape */
    double diagonal;  /* of this box, rounded */

    /* Of a shape that was read from a file; else 0, or what hausbench_shape_stating was given. */
    int64_t segments;       /* line segments, which are triangles (a, b, b) */
    int64_t single_points;  /* single points of a mesh, which are triangles (a, a, a) */
    int64_t dropped_points; /* by drop_invalid, and */
    int64_t dropped_faces;  /* faces that used such points */
    double unit;            /* length in metres of the unit that the file states or its format defines; 0: not stated */
    int32_t up;             /* the axis that points up, 'X', 'Y' or 'Z'; 0: not stated */
    int32_t reserved2;
} hausbench_description;
#define HAUSBENCH_DESCRIPTION_INIT \
    { sizeof(hausbench_description), 0, 0, 0, 0, {0, 0, 0, 0, 0, 0}, 0, 0, 0, 0, 0, 0, 0, 0 }

HAUSBENCH_API int hausbench_describe(const hausbench_shape* shape, hausbench_description* description,
                                     hausbench_error* error);

/* What else you should know about a file that was read, such as parts that were left out: each note is one line. NULL
   from their number on. The text lives as long as the shape. */
HAUSBENCH_API const char* hausbench_note(const hausbench_shape* shape, size_t number);

/* As hausbench_shape_of, for arrays whose unit or axes you know, or a copy of a shape that was read elsewhere: takes
   `unit`, `up` and the four numbers before them from a description, and ignores its other members. */
HAUSBENCH_API int hausbench_shape_stating(const hausbench_array* vertices, const hausbench_array* faces,
                                          const hausbench_description* about, hausbench_shape** shape,
                                          hausbench_error* error);

/* Copies the rows out: vertices has room for 3 * description.vertices numbers, faces for 3 * description.faces. Either
   may be NULL. */
HAUSBENCH_API int hausbench_copy_out(const hausbench_shape* shape, double* vertices, int64_t* faces,
                                     hausbench_error* error);

/* Pairs keep what they need of a shape, so it may be released at once. NULL is allowed, here and below. */
HAUSBENCH_API void hausbench_shape_release(hausbench_shape* shape);

/* --- pairs ------------------------------------------------------------------------------------------------------- */

/* A source A and a target B with the structures that answers need. */
typedef struct hausbench_pair hausbench_pair;

enum { HAUSBENCH_DIRECTED = 0, HAUSBENCH_SYMMETRIC = 1, HAUSBENCH_DISTRIBUTION = 2, HAUSBENCH_NOTHING = 3 };

typedef struct hausbench_plan {
    size_t size;
    const char* solver;            /* NULL: `cover` if a mesh is among the shapes, else `scan`; see hausbench_solver */
    const char* const* parameters; /* of this solver, each "name=value"; NULL: none */
    size_t parameter_count;
    int32_t threads; /* most threads for preparing */
    int32_t first;   /* what to prepare at once: DIRECTED, SYMMETRIC, DISTRIBUTION or NOTHING */
    int32_t moves;   /* 1: prepare for poses of A; 2: for poses of B; 3: for both */
    int32_t reserved;
} hausbench_plan;
#define HAUSBENCH_PLAN_INIT \
    { sizeof(hausbench_plan), NULL, NULL, 0, 1, HAUSBENCH_DIRECTED, 0, 0 }

/* Makes a pair. Everything that an answer needs and that was not prepared here is prepared by the first call that needs
   it. Structures over a shape that another pair has built already are used again. Fails with BAD_INPUT if both shapes
   state a unit, or both an axis that points up, and these differ: read both with the same `unit` and `up`. */
HAUSBENCH_API int hausbench_prepare(const hausbench_shape* source, const hausbench_shape* target,
                                    const hausbench_plan* plan, hausbench_pair** pair, hausbench_error* error);

HAUSBENCH_API void hausbench_pair_release(hausbench_pair* pair);

/* A chain of answers for nearby poses of one pair. Each answer starts from what the one before found, which makes it
   faster and changes no bound's truth. A chain may outlive the handle of its pair. */
typedef struct hausbench_chain hausbench_chain;

HAUSBENCH_API int hausbench_chain_begin(const hausbench_pair* pair, hausbench_chain** chain, hausbench_error* error);
HAUSBENCH_API void hausbench_chain_release(hausbench_chain* chain);

/* --- questions and answers --------------------------------------------------------------------------------------- */

typedef struct hausbench_interval {
    double lower, upper;
} hausbench_interval;

/* The unit of a tolerance. */
enum {
    /* Of the diagonal of the box of A at rest. If A is a single point, of the box of both shapes; if that is a point,
       too, the tolerance is a length. */
    HAUSBENCH_OF_DIAGONAL = 0,
    HAUSBENCH_OF_LENGTH = 1, /* the tolerance is a length */
    HAUSBENCH_OF_LOWER = 2   /* of the lower bound of the answer */
};

typedef struct hausbench_query {
    size_t size;
    double tolerance;    /* largest upper - lower that the caller accepts, in units of `relative_to`; above 0 */
    int32_t relative_to; /* HAUSBENCH_OF_... */
    int32_t threads;     /* most threads; the answer does not depend on them */
    double time_limit;   /* seconds for solving; the answer is then wider, and still holds */

    /* 16 numbers each, the rows of a 4 x 4 matrix whose last row is 0 0 0 1; NULL: at rest. A point p moves to
       ((m0 x + m1 y) + m2 z) + m3 and so on, rounded after each operation; the answer is about the moved points. */
    const double* source_pose;
    const double* target_pose;
    hausbench_chain* chain; /* NULL: none */

    /* Called every few milliseconds by the thread that called the library, in the default floating-point environment,
       while the thread prepares or solves (not while it waits for other threads, nor while a few large steps of
       preparing last, such as a sort). If it returns something else than 0, the call ends soon with the bounds found so
       far and the status CANCELLED. NULL: none. It must not call the library with the same chain, must not wait for
       another thread that uses the same shapes, and must not throw. (hausbench_prepare has no such function: with
       plan.first = NOTHING the first question prepares.) */
    int (*cancel)(void* cancel_data);
    void* cancel_data;

    /* For distributions. */
    double share_tolerance;  /* of shares, which have no unit */
    int32_t weigh_by_number; /* 0: parts of a mesh count by area; 1: each vertex of a mesh counts once */
    int32_t reserved;

    /* Called as `cancel` is, at most every tenth of a second while the thread solves, with the bounds so far, which hold:
       of the distance, or of each of the `count` statistics. `bounds` may be read until it returns. Result and rules as of
       `cancel`. NULL: none. Solvers that learn their bounds only at the end do not call it. */
    int (*progress)(void* progress_data, const hausbench_interval* bounds, size_t count);
    void* progress_data;
} hausbench_query;
#define HAUSBENCH_QUERY_INIT                                                                                         \
    {                                                                                                                \
        sizeof(hausbench_query), 1e-6, HAUSBENCH_OF_DIAGONAL, 1, INFINITY, NULL, NULL, NULL, NULL, NULL, 1e-3, 0, 0, \
            NULL, NULL                                                                                               \
    }

enum {
    HAUSBENCH_CONVERGED = 0,  /* the interval is within the tolerance */
    HAUSBENCH_WITHIN = 1,     /* hausbench_within: the distance is at most the length */
    HAUSBENCH_ABOVE = 2,      /* hausbench_within: the distance is above the length */
    HAUSBENCH_TIME_LIMIT = 3, /* in the cases from here on the interval is wider than asked for, and holds */
    HAUSBENCH_CANCELLED = 4,
    HAUSBENCH_PRECISION = 5, /* doubles are too coarse for this tolerance */
    HAUSBENCH_STALLED = 6    /* the input is too hard for the solver */
};

typedef struct hausbench_answer {
    size_t size;
    int32_t status;
    int32_t to_source;         /* 1: the witness is the farthest point of B from A (H(A,B) alone); 0: of A from B */
    hausbench_interval bounds; /* lower <= the quantity <= upper, whatever the status */
    double source_point[3];    /* the witness of the lower bound: a point of A, and */
    double target_point[3];    /* a point of B; one of them is nearest to the other, see to_source; NaN if unknown */
    int64_t source_row;        /* the triangle or point that each lies on; -1: unknown */
    int64_t target_row;
    double prepare_seconds; /* wall time of this call: for preparing, and for solving */
    double solve_seconds;
} hausbench_answer;
#define HAUSBENCH_ANSWER_INIT \
    { sizeof(hausbench_answer), 0, 0, {0, INFINITY}, {NAN, NAN, NAN}, {NAN, NAN, NAN}, -1, -1, 0, 0 }

/* Bounds h(A,B). */
HAUSBENCH_API int hausbench_directed(hausbench_pair* pair, const hausbench_query* query, hausbench_answer* answer,
                                     hausbench_error* error);

/* Bounds H(A,B). */
HAUSBENCH_API int hausbench_symmetric(hausbench_pair* pair, const hausbench_query* query, hausbench_answer* answer,
                                      hausbench_error* error);

/* Asks whether h(A,B) <= length, or H(A,B) <= length if `symmetric` is 1. This is often much cheaper than the distance.
   The tolerance is ignored. The status is WITHIN, ABOVE, or says why neither is proven. If the length is very close to
   the distance, that may never be decided, so a query without a time limit ends after 10 seconds, with the status
   TIME_LIMIT. With ABOVE, the upper bound may be INFINITY. */
HAUSBENCH_API int hausbench_within(hausbench_pair* pair, int32_t symmetric, double length, const hausbench_query* query,
                                   hausbench_answer* answer, hausbench_error* error);

/* Bounds statistics of the distance of the points of A to B, each into values[i]. Each is a text, such as
   "mean" or "quantile 0.95" (docs/conventions.md lists them); one of "target", "larger", "mean_of_both",
   "harmonic_mean" and "pooled" may follow. The solver of the plan is not used. answer->bounds is
   values[0]. */
HAUSBENCH_API int hausbench_distribution(hausbench_pair* pair, const char* const* statistics, size_t count,
                                         const hausbench_query* query, hausbench_interval* values,
                                         hausbench_answer* answer, hausbench_error* error);

/* Bounds the distance to B of each vertex of A, with those that no face uses, into values[vertex]; `nearest`, unless it
   is NULL, gets the row of B nearest to it. The tolerance is ignored: the width of each interval is the rounding error
   at the largest coordinate of the vertex and of B. (If another vertex of A is more than 1e100 times as far away, the
   intervals are wider.) Each call builds a tree over B. If the time limit or `cancel` ends the call early, the other
   vertices have [0, INFINITY] and the row -1. O((|A| + |B|) log |B|) on well-behaved shapes. */
HAUSBENCH_API int hausbench_field(hausbench_pair* pair, const hausbench_query* query, hausbench_interval* values,
                                  int64_t* nearest, hausbench_error* error);

/* --- proofs ------------------------------------------------------------------------------------------------------ */

/* Bounds h(A,B), or H(A,B) if `symmetric` is 1, and writes a proof of the upper bound to a file (docs/certificate.md),
   which hausbench_verify and `hausbench verify --certificate` check. Fails with BAD_INPUT, and writes nothing, if the
   solver writes no proofs or had no time to write this one, or if a pose does not keep distances. If memory runs out
   while a proof is written or read, the JSON library may end the process. Checking the proof takes about as long as
   finding it, and neither the time limit nor `cancel` ends that. */
HAUSBENCH_API int hausbench_certify(hausbench_pair* pair, int32_t symmetric, const hausbench_query* query,
                                    const char* path, hausbench_answer* answer, hausbench_error* error);

typedef struct hausbench_verdict {
    size_t size;
    int32_t accepted; /* 1: the proof holds */
    int32_t reserved;
    hausbench_interval bounds; /* as the file states them; [0, INFINITY] if its bounds are out of order */
    double proven;             /* the upper bound that the proof proves: at most bounds.upper if it is accepted */
    char text[1024];           /* what was checked, or why the proof is refused; one line */
    double source_pose[16], target_pose[16]; /* of the file, as in hausbench_query */
} hausbench_verdict;
#define HAUSBENCH_VERDICT_INIT                                                    \
    {                                                                             \
        sizeof(hausbench_verdict), 0, 0, {0, INFINITY}, INFINITY, {0}, {0}, { 0 } \
    }

/* Checks a proof about shapes at rest with code that shares no bound with the solvers. The call also succeeds if the proof
   is refused: see verdict->accepted. A proof about a pose is refused. Fails with BAD_INPUT if the file cannot be read or
   is about other shapes. */
HAUSBENCH_API int hausbench_verify(const char* path, const hausbench_shape* source, const hausbench_shape* target,
                                   hausbench_verdict* verdict, hausbench_error* error);

/* The same for shapes at poses, as in hausbench_query; NULL: at rest. A proof about other poses is refused. */
HAUSBENCH_API int hausbench_verify_posed(const char* path, const hausbench_shape* source, const hausbench_shape* target,
                                         const double* source_pose, const double* target_pose,
                                         hausbench_verdict* verdict, hausbench_error* error);

/* --- about this library ------------------------------------------------------------------------------------------ */

HAUSBENCH_API const char* hausbench_version(void);         /* "0.1.0" */
HAUSBENCH_API int hausbench_interface(void);               /* HAUSBENCH_INTERFACE of the library that runs */
HAUSBENCH_API const char* hausbench_solver(size_t number); /* names for hausbench_plan; NULL from their number on */

#ifdef __cplusplus
}
#endif
#endif
