// Renders a scene through the C API, and tries what a host must be able to rely on: errors with their places, progress,
// cancelling, files from memory, NULL everywhere. Prints the hash of the picture; ends with 1 at the first thing that is
// not as expected. With an argument it also writes the picture there.

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rtscript.h"

#define CHECK(condition) \
    do { \
        if (!(condition)) { \
            fprintf(stderr, "%s:%d: not so: %s\n", __FILE__, __LINE__, #condition); \
            exit(1); \
        } \
    } while (0)

static const char *const SCENE =
    "let radius = param(\"radius\", 1.0, #{ min: 0.1, max: 2.0 });\n"
    "size(160, 120);\n"
    "light([5, 5, 5], [1, 1, 1]);\n"
    "diffuse(0.9, 0.3, 0.2);\n"
    "sphere(0, 0, 0, radius);\n"
    "print(`radius ${radius}`);\n";

struct Seen {
    int calls;
    uint64_t done, total;
    int stop_after;
    char printed[64];
    int reads;
};

// Reports what is wrong and ends: what a program does with an error that it does not expect.
static void must(RtsStatus status, RtsError **error) {
    if (status != RTS_STATUS_OK) {
        fprintf(stderr, "%s: %s\n", rts_status_name(status), rts_error_text(*error));
        rts_error_free(*error);
        exit(1);
    }
    CHECK(*error == NULL);
}

static int32_t on_progress(void *user, uint64_t done, uint64_t total) {
    struct Seen *seen = user;
    seen->calls++;
    seen->done = done;
    seen->total = total;
    return seen->stop_after > 0 && seen->calls >= seen->stop_after;
}

static void on_print(void *user, const char *text) {
    struct Seen *seen = user;
    snprintf(seen->printed, sizeof seen->printed, "%s", text);
}

static int32_t on_read(void *user, const char *path, uint64_t max_bytes, RtsBytes *bytes) {
    struct Seen *seen = user;
    seen->reads++;
    CHECK(max_bytes > 0);
    if (strcmp(path, "secret.rhai") == 0) return RTS_STATUS_DENIED;
    if (strcmp(path, "lib/ball.rhai") != 0) return RTS_STATUS_INPUT;
    const char *first = "fn ball(r) { diffuse(0.9, 0.3, 0.2);";
    const char *second = " sphere(0, 0, 0, r); }";
    CHECK(rts_bytes_put(bytes, (const uint8_t *)first, strlen(first)) == RTS_STATUS_OK);
    CHECK(rts_bytes_put(bytes, (const uint8_t *)second, strlen(second)) == RTS_STATUS_OK);
    CHECK(rts_bytes_put(bytes, NULL, 1) == RTS_STATUS_ARGUMENT);
    return RTS_STATUS_OK;
}

static RtsScript *compile(const char *text) {
    RtsScript *script = NULL;
    RtsError *error = NULL;
    must(rts_script_compile("scene.rhai", text, strlen(text), RTS_LIMITS_DEFAULT, &script, &error), &error);
    return script;
}

// A picture, its pixels in every form, progress, what was printed.
static void render_scene(const char *path) {
    struct Seen seen = {0};
    RtsScript *script = compile(SCENE);
    RtsOptions *options = rts_options_new();
    RtsError *error = NULL;
    must(rts_options_set(options, "radius", "1.25", &error), &error);
    must(rts_options_set(options, "size", "64x48", &error), &error);
    must(rts_options_set(options, "samples", "2", &error), &error);
    must(rts_options_set(options, "seed", "7", &error), &error);
    CHECK(rts_options_threads(options, 2) == RTS_STATUS_OK);
    CHECK(rts_options_progress(options, on_progress, &seen) == RTS_STATUS_OK);
    CHECK(rts_options_print(options, on_print, &seen) == RTS_STATUS_OK);

    RtsRun *run = NULL;
    must(rts_script_run(script, options, &run, &error), &error);
    CHECK(strcmp(seen.printed, "radius 1.25") == 0);
    rts_script_free(script);
    CHECK(rts_run_picture_count(run) == 0);

    RtsImage *image = NULL;
    must(rts_run_render(run, options, &image, &error), &error);
    rts_run_free(run);
    rts_options_free(options);
    CHECK(seen.calls > 0 && seen.total == 64 * 48 && seen.done == seen.total);

    size_t length = 0;
    CHECK(rts_image_width(image) == 64 && rts_image_height(image) == 48);
    const uint8_t *rgb = rts_image_rgb8(image, &length);
    CHECK(rgb != NULL && length == 64 * 48 * 3);
    size_t middle = (24 * 64 + 32) * 3;
    CHECK(rgb[middle] > rgb[middle + 1] && rgb[middle + 1] > rgb[middle + 2]);
    const double *linear = rts_image_linear(image, &length);
    CHECK(linear != NULL && length == 64 * 48 * 3 && linear[middle] > linear[middle + 1]);
    const float *narrow = rts_image_linear_f32(image, &length);
    CHECK(narrow != NULL && length == 64 * 48 * 3 && narrow[middle] == (float)linear[middle]);
    const uint8_t *png = rts_image_png(image, &length);
    CHECK(png != NULL && length > 8 && memcmp(png, "\x89PNG", 4) == 0);
    CHECK(rts_image_rgb8(image, NULL) == rgb);
    CHECK(rts_image_warning_count(image) == 0);
    printf("hash %s\n", rts_image_hash(image));

    if (path != NULL) must(rts_image_save(image, path, &error), &error);
    CHECK(rts_image_save(image, "no.such.ending", &error) == RTS_STATUS_OUTPUT);
    CHECK(strstr(rts_error_text(error), "known are .png") != NULL);
    rts_error_free(error);
    rts_image_free(image);
}

// An error tells where, what, and what to write instead; several are told at once.
static void errors_have_places(void) {
    const char *text = "light([5, 5, 5], [1, 1, 1]);\nsphere(0, 0, 0, 1);\n  sphre(0, 0, 0, 1);\n";
    RtsScript *script = compile(text);
    RtsRun *run = (RtsRun *)&run;
    RtsError *error = NULL;
    CHECK(rts_script_run(script, NULL, &run, &error) == RTS_STATUS_SCRIPT);
    CHECK(run == NULL && rts_error_status(error) == RTS_STATUS_SCRIPT && rts_error_count(error) == 1);
    const RtsDiagnostic *d = rts_error_diagnostic(error, 0);
    CHECK(strcmp(rts_diagnostic_code(d), "unknown-function") == 0);
    CHECK(strcmp(rts_diagnostic_file(d), "scene.rhai") == 0);
    CHECK(rts_diagnostic_line(d) == 3 && rts_diagnostic_column(d) == 3);
    CHECK(strcmp(rts_diagnostic_source_line(d), "  sphre(0, 0, 0, 1);") == 0);
    CHECK(strstr(rts_diagnostic_message(d), "sphre") != NULL);
    CHECK(rts_diagnostic_hint_count(d) > 0 && strstr(rts_diagnostic_hint(d, 0), "sphere") != NULL);
    CHECK(rts_diagnostic_hint(d, 1000) == NULL && rts_diagnostic_note(d, 1000) == NULL);
    CHECK(strstr(rts_error_text(error), "scene.rhai:3:3: error: ") == rts_error_text(error));
    CHECK(rts_error_diagnostic(error, 1) == NULL);
    printf("error %s\n", rts_diagnostic_text(d));
    rts_error_free(error);
    // Nobody has to want the error.
    CHECK(rts_script_run(script, NULL, &run, NULL) == RTS_STATUS_SCRIPT);
    rts_script_free(script);

    const char *two = "sphere(0, 0, 0 1);\nlet a = ;\n";
    CHECK(rts_script_compile("two.rhai", two, strlen(two), RTS_LIMITS_DEFAULT, &script, &error) == RTS_STATUS_SCRIPT);
    CHECK(script == NULL && rts_error_count(error) == 2);
    CHECK(rts_diagnostic_line(rts_error_diagnostic(error, 0)) == 1);
    CHECK(rts_diagnostic_line(rts_error_diagnostic(error, 1)) == 2);
    rts_error_free(error);
}

// A scene that shows nothing gives a picture and warnings.
static void warnings_are_listed(void) {
    RtsScript *script = compile("size(8, 8); pushTransform(); sphere(0, 0, 0, 1);");
    RtsRun *run = NULL;
    RtsImage *image = NULL;
    RtsError *error = NULL;
    must(rts_script_run(script, NULL, &run, &error), &error);
    must(rts_run_render(run, NULL, &image, &error), &error);
    CHECK(rts_run_warning_count(run) > 0);
    CHECK(rts_diagnostic_line(rts_run_warning(run, 0)) == 1);
    CHECK(rts_run_warning(run, rts_run_warning_count(run)) == NULL);
    rts_image_free(image);
    rts_run_free(run);
    rts_script_free(script);
}

// Files by callback and from memory; those that there are not, and those that are refused.
static void files_are_asked_for(void) {
    struct Seen seen = {0};
    RtsError *error = NULL;
    RtsRun *run = NULL;
    RtsOptions *options = rts_options_new();
    CHECK(rts_options_reader(options, on_read, &seen) == RTS_STATUS_OK);

    RtsScript *script = compile("import \"lib/x/../ball\" as b; b::ball(1.0); render(\"a.png\");");
    must(rts_options_set(options, "size", "8x8", &error), &error);
    must(rts_script_run(script, options, &run, &error), &error);
    CHECK(seen.reads == 1 && rts_run_picture_count(run) == 1);
    CHECK(strcmp(rts_run_picture_name(run, 0), "a.png") == 0 && rts_run_picture_name(run, 1) == NULL);
    RtsImage *last = NULL, *first = NULL;
    must(rts_run_render(run, NULL, &last, &error), &error);
    must(rts_run_picture(run, 0, &first, &error), &error);
    CHECK(strcmp(rts_image_hash(last), rts_image_hash(first)) == 0);
    rts_image_free(last);
    rts_image_free(first);
    CHECK(rts_run_picture(run, 1, &first, &error) == RTS_STATUS_ARGUMENT && first == NULL);
    rts_error_free(error);
    rts_run_free(run);
    rts_script_free(script);

    script = compile("import \"secret\" as s;");
    CHECK(rts_script_run(script, options, &run, &error) == RTS_STATUS_DENIED);
    rts_error_free(error);
    rts_script_free(script);
    script = compile("mesh(\"none.obj\");");
    CHECK(rts_script_run(script, options, &run, &error) == RTS_STATUS_INPUT);
    rts_error_free(error);
    const char *obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    CHECK(rts_options_file(options, "none.obj", (const uint8_t *)obj, strlen(obj)) == RTS_STATUS_OK);
    must(rts_script_run(script, options, &run, &error), &error);
    rts_run_free(run);
    rts_script_free(script);
    int before = seen.reads;
    script = compile("mesh(\"../none.obj\");");
    CHECK(rts_script_run(script, options, &run, &error) == RTS_STATUS_DENIED && seen.reads == before);
    rts_error_free(error);
    CHECK(rts_options_folder(options, ".") == RTS_STATUS_OK);
    CHECK(rts_script_run(script, options, &run, &error) == RTS_STATUS_DENIED);
    rts_error_free(error);
    rts_script_free(script);
    rts_options_free(options);
}

// The callback ends a render; so do options that were cancelled, a script without end included.
static void renders_are_cancelled(void) {
    struct Seen seen = {.stop_after = 1};
    RtsError *error = NULL;
    RtsRun *run = NULL;
    RtsImage *image = (RtsImage *)&image;
    RtsOptions *options = rts_options_new();
    RtsScript *script = compile(SCENE);
    must(rts_script_run(script, options, &run, &error), &error);
    CHECK(rts_options_progress(options, on_progress, &seen) == RTS_STATUS_OK);
    CHECK(rts_run_render(run, options, &image, &error) == RTS_STATUS_CANCELLED);
    CHECK(image == NULL && seen.calls == 1 && seen.done < seen.total);
    CHECK(strcmp(rts_diagnostic_code(rts_error_diagnostic(error, 0)), "cancelled") == 0);
    rts_error_free(error);
    // It was that render which was stopped, not the options.
    seen.stop_after = 0;
    must(rts_run_render(run, options, &image, &error), &error);
    rts_image_free(image);
    rts_run_free(run);
    rts_script_free(script);

    rts_options_cancel(options);
    script = compile("loop { }");
    CHECK(rts_script_run(script, options, &run, &error) == RTS_STATUS_CANCELLED);
    rts_error_free(error);
    rts_script_free(script);
    rts_options_free(options);
}

static void strangers_have_limits(void) {
    // A limit that is reached at once, also where every instruction takes fifty times as long.
    const char *text = "let s = \"ball\"; loop { s += s; }";
    RtsScript *script = NULL;
    RtsRun *run = NULL;
    RtsError *error = NULL;
    must(rts_script_compile("s", text, strlen(text), RTS_LIMITS_UNTRUSTED, &script, &error), &error);
    CHECK(rts_script_run(script, NULL, &run, &error) == RTS_STATUS_LIMIT);
    CHECK(strstr(rts_error_text(error), "string_bytes") != NULL);
    rts_error_free(error);
    rts_script_free(script);
    CHECK(rts_script_compile("s", text, strlen(text), 7, &script, &error) == RTS_STATUS_ARGUMENT);
    rts_error_free(error);
}

// NULL is an error or an empty answer, never a crash; so is text that is not UTF-8.
static void nothing_is_an_answer(void) {
    RtsError *error = NULL;
    RtsScript *script = NULL;
    RtsRun *run = NULL;
    RtsImage *image = NULL;
    size_t length = 1;
    RtsStatus argument = RTS_STATUS_ARGUMENT;
    CHECK(rts_script_compile(NULL, "", 0, 0, &script, &error) == argument);
    CHECK(strstr(rts_error_text(error), "name of the script is NULL") != NULL);
    rts_error_free(error);
    CHECK(rts_script_compile("s", NULL, 1, 0, &script, NULL) == argument);
    CHECK(rts_script_compile("s", "", SIZE_MAX, 0, &script, NULL) == argument);
    CHECK(rts_script_compile("s", "", 0, 0, NULL, NULL) == argument);
    CHECK(rts_script_compile("s\xff", "", 0, 0, &script, NULL) == argument);
    CHECK(rts_script_compile("s", "\xc3(", 2, 0, &script, NULL) == argument && script == NULL);
    CHECK(rts_script_compile("s", "a\0b", 3, 0, &script, NULL) == RTS_STATUS_SCRIPT && script == NULL);
    must(rts_script_compile("s", NULL, 0, 0, &script, &error), &error);
    rts_script_free(script);
    CHECK(rts_script_run(NULL, NULL, &run, NULL) == argument && run == NULL);
    CHECK(rts_run_render(NULL, NULL, &image, NULL) == argument && image == NULL);
    CHECK(rts_run_picture(NULL, 0, &image, NULL) == argument);
    CHECK(rts_image_save(NULL, "a.png", NULL) == argument);
    CHECK(rts_options_set(NULL, "a", "b", NULL) == argument);
    RtsOptions *options = rts_options_new();
    CHECK(rts_options_set(options, NULL, "b", NULL) == argument);
    CHECK(rts_options_set(options, "a", NULL, NULL) == argument);
    CHECK(rts_options_set(options, "size", "b", &error) == argument);
    CHECK(strstr(rts_error_text(error), "640x480") != NULL);
    rts_error_free(error);
    CHECK(rts_options_threads(options, 1025) == argument);
    CHECK(rts_options_folder(options, NULL) == argument);
    CHECK(rts_options_file(options, "a", NULL, 1) == argument);
    CHECK(rts_options_reader(options, NULL, NULL) == RTS_STATUS_OK);
    rts_options_free(options);
    CHECK(rts_options_threads(NULL, 1) == argument && rts_options_folder(NULL, ".") == argument);
    CHECK(rts_options_file(NULL, "a", NULL, 0) == argument && rts_options_reader(NULL, NULL, NULL) == argument);
    CHECK(rts_options_print(NULL, NULL, NULL) == argument && rts_options_progress(NULL, NULL, NULL) == argument);
    CHECK(rts_bytes_put(NULL, NULL, 0) == argument);
    rts_options_cancel(NULL);

    CHECK(rts_image_width(NULL) == 0 && rts_image_height(NULL) == 0 && rts_image_hash(NULL) == NULL);
    CHECK(rts_image_rgb8(NULL, &length) == NULL && length == 0 && rts_image_linear(NULL, NULL) == NULL);
    CHECK(rts_image_linear_f32(NULL, NULL) == NULL && rts_image_png(NULL, NULL) == NULL);
    CHECK(rts_image_warning_count(NULL) == 0 && rts_image_warning(NULL, 0) == NULL);
    CHECK(rts_run_picture_count(NULL) == 0 && rts_run_picture_name(NULL, 0) == NULL);
    CHECK(rts_run_warning_count(NULL) == 0 && rts_run_warning(NULL, 0) == NULL);
    CHECK(rts_error_status(NULL) == RTS_STATUS_OK && rts_error_text(NULL) == NULL && rts_error_count(NULL) == 0);
    const RtsDiagnostic *d = rts_error_diagnostic(NULL, 0);
    CHECK(d == NULL && rts_error_warning_count(NULL) == 0 && rts_error_warning(NULL, 0) == NULL);
    CHECK(rts_diagnostic_code(d) == NULL && rts_diagnostic_message(d) == NULL && rts_diagnostic_file(d) == NULL);
    CHECK(rts_diagnostic_line(d) == 0 && rts_diagnostic_column(d) == 0 && rts_diagnostic_source_line(d) == NULL);
    CHECK(rts_diagnostic_note_count(d) == 0 && rts_diagnostic_note(d, 0) == NULL);
    CHECK(rts_diagnostic_hint_count(d) == 0 && rts_diagnostic_hint(d, 0) == NULL && rts_diagnostic_text(d) == NULL);
    rts_script_free(NULL);
    rts_options_free(NULL);
    rts_run_free(NULL);
    rts_image_free(NULL);
    rts_error_free(NULL);
}

int main(int argc, char **argv) {
    printf("version %s\n", rts_version());
    render_scene(argc > 1 ? argv[1] : NULL);
    errors_have_places();
    warnings_are_listed();
    files_are_asked_for();
    renders_are_cancelled();
    strangers_have_limits();
    nothing_is_an_answer();
    return 0;
}
