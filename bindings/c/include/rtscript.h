// rtscript: pictures written as code. The C API; bindings/README.md tells how to build and link it.
//
// What holds for every function:
//
// - Handles (RtsScript, RtsOptions, RtsRun, RtsImage, RtsError) come from a function that says so and belong to the
//   caller, who ends each with its `_free` function, once. NULL may be freed.
// - Every other pointer that a function returns (texts, pixels, diagnostics) belongs to the handle it was asked of,
//   and is good until that handle is freed. Nothing of it is to be changed or freed.
// - Texts are UTF-8 and end in a zero. What is not UTF-8, or NULL where a value is needed, is an error of
//   RTS_STATUS_ARGUMENT. A pointer that is neither NULL nor what the function asks for cannot be told apart from
//   one that is: that is up to the caller.
// - What is asked of a NULL handle is answered with NULL, 0 or RTS_STATUS_OK, so a chain of questions needs no tests.
// - Functions that can fail return a RtsStatus. Where `error` is not NULL, `*error` becomes a handle that tells what
//   was wrong, or NULL where nothing was. Results are NULL where there is none. What stood in `*error` or in the
//   result's place before is overwritten, not freed.
// - Handles may be used from any thread, scripts, runs and images from several at once. Options must not be
//   changed by one thread while another uses them; rts_options_cancel is the exception.
// - Callbacks get the `user` pointer that was given along with them, must be safe to call from other threads than
//   the one that set them, must return (no longjmp, no C++ exception), and must outlive the options.
// - No fault of rtscript's own unwinds into C: it becomes an error of RTS_STATUS_INTERNAL.
//
// Scripts of strangers: RTS_LIMITS_UNTRUSTED bounds time, sizes and numbers, each with an error that names the
// limit. It does not meter memory, and no limit bounds how long a render takes: cancel it from the progress callback,
// and give the process that does it a limit of memory.


#ifndef RTSCRIPT_H
#define RTSCRIPT_H

#include <stddef.h>
#include <stdint.h>

// Limits for one's own scripts: 60 s of script time, 20 million shapes, pictures of 256 million pixels.
#define RTS_LIMITS_DEFAULT 0

// Limits for scripts of strangers: 5 s of script time, 200,000 shapes, pictures of 2 million pixels and less.
#define RTS_LIMITS_UNTRUSTED 1

// How a function ended: well, or whose fault it was that it did not.
typedef enum {
    // It is done.
    RTS_STATUS_OK = 0,
    // The script or the scene that it describes is wrong.
    RTS_STATUS_SCRIPT = 1,
    // A file that was to be read is missing or malformed.
    RTS_STATUS_INPUT = 2,
    // The picture cannot be written.
    RTS_STATUS_OUTPUT = 3,
    // A limit was reached; the message names it.
    RTS_STATUS_LIMIT = 4,
    // The script asked for what it may not have, such as a file outside of its folder.
    RTS_STATUS_DENIED = 5,
    // It was stopped by the progress callback or by rts_options_cancel.
    RTS_STATUS_CANCELLED = 6,
    // A fault of rtscript's own.
    RTS_STATUS_INTERNAL = 7,
    // A fault of the caller: a NULL where a value is needed, a text that is not UTF-8, an unknown number.
    RTS_STATUS_ARGUMENT = 8,
} RtsStatus;

// Takes the bytes of a file from the reading callback, and is good until that returns.
typedef struct RtsBytes RtsBytes;

// One message with its place: an error or a warning.
typedef struct RtsDiagnostic RtsDiagnostic;

// Why something was not done: one error or several, and the warnings that came before.
typedef struct RtsError RtsError;

// A picture. What is asked of it is made once and kept with it.
typedef struct RtsImage RtsImage;

// What the caller decides about a run or a render: parameters, threads, files, callbacks.
typedef struct RtsOptions RtsOptions;

// What a script left behind: the scene, the pictures that it rendered, warnings.
typedef struct RtsRun RtsRun;

// A script that has been read and can be run any number of times, by several threads at once.
typedef struct RtsScript RtsScript;

// Is asked for the file `path`, a relative path with '/' and without '.' and '..'. It hands over the bytes by
// rts_bytes_put, in one piece or several, and returns RTS_STATUS_OK; or RTS_STATUS_DENIED where the script may not
// read it, and anything else where there is no such file. More than `max_bytes` is an error of RTS_STATUS_LIMIT. It is
// called on the thread that called rts_script_run.
typedef int32_t (*RtsRead)(void *user, const char *path, uint64_t max_bytes, RtsBytes *bytes);

// Receives a line that the script printed, on the thread that called rts_script_run. The text is good until it returns.
typedef void (*RtsPrint)(void *user, const char *text);

// Is told how far a render is: `done` of `total` pixels. What is not 0 stops it, with an error of
// RTS_STATUS_CANCELLED. It is called now and then, from any of the threads that render, never from two of one render
// at once.
typedef int32_t (*RtsProgress)(void *user, uint64_t done, uint64_t total);

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// The version of rtscript, such as "0.1.0". Is never freed.
const char *rts_version(void);

// A word for a status: "ok", "script", "input", "output", "limit", "denied", "cancelled", "internal", "argument".
// Is never freed.
const char *rts_status_name(uint32_t status);

// Ends an error, and with it all its texts and diagnostics.
void rts_error_free(RtsError *error);

// Whose fault it was: what the function that failed has returned.
RtsStatus rts_error_status(const RtsError *error);

// All errors as text of several lines, as a compiler writes them: place, message, notes, hints.
const char *rts_error_text(const RtsError *error);

// How many errors there are, at least 1: what ended the run, then what else is wrong with the script.
size_t rts_error_count(const RtsError *error);

// One of the errors, counted from 0; NULL past their end.
const RtsDiagnostic *rts_error_diagnostic(const RtsError *error, size_t index);

// How many warnings came before the error.
size_t rts_error_warning_count(const RtsError *error);

// One of the warnings that came before the error, counted from 0; NULL past their end.
const RtsDiagnostic *rts_error_warning(const RtsError *error, size_t index);

// The class, which stays where words change: "unknown-function"; `rtscript help CLASS` explains it.
const char *rts_diagnostic_code(const RtsDiagnostic *diagnostic);

// What is wrong, in one line.
const char *rts_diagnostic_message(const RtsDiagnostic *diagnostic);

// The file that it is about, under the name it was given or named by; NULL where there is none.
const char *rts_diagnostic_file(const RtsDiagnostic *diagnostic);

// The line, from 1; 0 where unknown.
uint32_t rts_diagnostic_line(const RtsDiagnostic *diagnostic);

// The column in characters, from 1; 0 where unknown.
uint32_t rts_diagnostic_column(const RtsDiagnostic *diagnostic);

// The text of that line; NULL where unknown.
const char *rts_diagnostic_source_line(const RtsDiagnostic *diagnostic);

// How many notes there are: further facts, such as the calls that led here.
size_t rts_diagnostic_note_count(const RtsDiagnostic *diagnostic);

// One of the notes, counted from 0; NULL past their end.
const char *rts_diagnostic_note(const RtsDiagnostic *diagnostic, size_t index);

// How many hints there are: what to write instead.
size_t rts_diagnostic_hint_count(const RtsDiagnostic *diagnostic);

// One of the hints, counted from 0; NULL past their end.
const char *rts_diagnostic_hint(const RtsDiagnostic *diagnostic, size_t index);

// All of it as text of several lines, as a compiler writes it.
const char *rts_diagnostic_text(const RtsDiagnostic *diagnostic);

// Appends `length` bytes to the file that the reading callback was asked for; they are copied. What is too much for
// the script's limits is not kept.
RtsStatus rts_bytes_put(RtsBytes *into,
                        const uint8_t *data,
                        size_t length);

// Ends an image, and with it its pixels and texts.
void rts_image_free(RtsImage *image);

// Pixels across.
uint32_t rts_image_width(const RtsImage *image);

// Pixels down.
uint32_t rts_image_height(const RtsImage *image);

// The picture in 8 bits per channel: width * height * 3 bytes, red, green, blue, rows from the top without gaps.
// `*length` becomes the number of bytes; `length` may be NULL.
const uint8_t *rts_image_rgb8(const RtsImage *image,
                              size_t *length);

// The picture in scene-linear light: width * height * 3 numbers, red, green, blue, rows from the top without gaps.
// `*length` becomes the number of numbers; `length` may be NULL.
const double *rts_image_linear(const RtsImage *image,
                               size_t *length);

// As rts_image_linear, each number rounded to a float.
const float *rts_image_linear_f32(const RtsImage *image, size_t *length);

// The picture as a PNG file. `*length` becomes the number of bytes; `length` may be NULL. NULL where the picture is
// too large for the format.
const uint8_t *rts_image_png(const RtsImage *image,
                             size_t *length);

// The hash of the 8-bit pixels, 32 hexadecimal digits, as `rtscript hash` prints it: the same for a scene on every
// machine.
const char *rts_image_hash(const RtsImage *image);

// Writes the picture to a file, whole or not at all, in the format that its ending asks for: .png, .jpg, .jpeg, .ppm.
RtsStatus rts_image_save(const RtsImage *image,
                         const char *path,
                         RtsError **error);

// How many warnings came up while the picture was rendered; those of the script are the run's.
size_t rts_image_warning_count(const RtsImage *image);

// One of the warnings of the picture, counted from 0; NULL past their end.
const RtsDiagnostic *rts_image_warning(const RtsImage *image, size_t index);

// Options that decide nothing: the script's own size and samples, no files, all processors. Belongs to the caller.
RtsOptions *rts_options_new(void);

// Ends options.
void rts_options_free(RtsOptions *options);

// Decides a parameter: "size" ("640x480"), "samples", "seed", or one that the script declares by
// `param(name, default)`, as text: "0.5", "true". One that the script does not declare is an error of the run.
RtsStatus rts_options_set(RtsOptions *options,
                          const char *name,
                          const char *value,
                          RtsError **error);

// Renders with so many threads, at most 1024; 0, as it is at first, takes one for each processor.
RtsStatus rts_options_threads(RtsOptions *options, uint32_t threads);

// Lets scripts read regular files below a folder, and nothing outside of it. Takes the place of a reading callback.
RtsStatus rts_options_folder(RtsOptions *options,
                             const char *folder);

// Lets scripts read `length` bytes as the file `path`, a relative path with '/'. They are copied. Files in memory come
// before those of a folder or a callback.
RtsStatus rts_options_file(RtsOptions *options,
                           const char *path,
                           const uint8_t *data,
                           size_t length);

// Asks `read` for the files that a script reads; NULL for none. Takes the place of a folder.
RtsStatus rts_options_reader(RtsOptions *options, RtsRead read, void *user);

// Hands what scripts print to `print`; NULL, as it is at first, drops it.
RtsStatus rts_options_print(RtsOptions *options, RtsPrint print, void *user);

// Tells `progress` how far a render is, those that the script begins by `render()` included; NULL for nobody. What it
// returns can stop the run.
RtsStatus rts_options_progress(RtsOptions *options,
                               RtsProgress progress,
                               void *user);

// Stops every run and render that uses these options, now and later, with an error of RTS_STATUS_CANCELLED. May be
// called from any thread while they are in use. A script that is being read is not stopped.
void rts_options_cancel(const RtsOptions *options);

// Ends a run. Its images stay.
void rts_run_free(RtsRun *run);

// The picture of a run, as the command would write it: the last one that the script rendered by `render()`; where it
// never did, the scene is rendered now. `options` may be NULL; of them threads, progress and cancelling count here.
// `*image` belongs to the caller.
RtsStatus rts_run_render(const RtsRun *run,
                         const RtsOptions *options,
                         RtsImage **image,
                         RtsError **error);

// How many pictures the script rendered by itself.
size_t rts_run_picture_count(const RtsRun *run);

// The name under which the script rendered one of its pictures, counted from 0: `render("name.png")`; NULL where it has
// none. Nothing was written under it.
const char *rts_run_picture_name(const RtsRun *run,
                                 size_t index);

// One of the pictures that the script rendered by itself, counted from 0. `*image` belongs to the caller.
RtsStatus rts_run_picture(const RtsRun *run, size_t index, RtsImage **image, RtsError **error);

// How many warnings the run has.
size_t rts_run_warning_count(const RtsRun *run);

// One of the warnings of the run, counted from 0; NULL past their end.
const RtsDiagnostic *rts_run_warning(const RtsRun *run, size_t index);

// Reads a script of `length` bytes of UTF-8 text. `name` is the file as messages are to call it. `limits` is
// RTS_LIMITS_DEFAULT or RTS_LIMITS_UNTRUSTED and holds for its runs, too. `*script` belongs to the caller.
RtsStatus rts_script_compile(const char *name,
                             const char *source,
                             size_t length,
                             uint32_t limits,
                             RtsScript **script,
                             RtsError **error);

// Ends a script. Its runs stay.
void rts_script_free(RtsScript *script);

// Runs a script up to the complete scene. `options` may be NULL. What the script renders by `render()` is rendered on
// the way. `*run` belongs to the caller.
RtsStatus rts_script_run(const RtsScript *script,
                         const RtsOptions *options,
                         RtsRun **run,
                         RtsError **error);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* RTSCRIPT_H */
