"""The module does what the library does, and lets Python work meanwhile."""

import ast
import inspect
import os
import pathlib
import pickle
import signal
import subprocess
import sys
import threading

import numpy
import pytest

import rtscript

# The program of the README, and the hash it asserts there.
BALL = "light([5, 5, 5], [1, 1, 1]); diffuse(0.9, 0.3, 0.2); sphere(0, 0, 0, 1); size(64, 48);"
BALL_HASH = "08cfa5d9d46cd3fc557bbc4b84373d6b"

# Minutes of work: whoever does not stop it will be noticed.
LONG = """
size(2000, 2000); samples(4096); light([5, 5, 5], [1, 1, 1]); diffuse(1, 1, 1); specular(0.5, 0.5, 0.5);
for i in 0..100 { sphere(i % 10 - 5, i / 10 - 5, 0, 0.6); }
"""


def test_the_hash_is_the_one_of_the_readme():
    readme = pathlib.Path(__file__).parents[3] / "README.md"
    assert f'let source = "{BALL}";' in readme.read_text() and BALL_HASH in readme.read_text()
    assert rtscript.render(BALL).hash == BALL_HASH
    script = rtscript.Script(BALL, name="ball.rhai")
    assert script.name == "ball.rhai"
    for threads in (0, 1, 3):
        assert script.run().render(threads=threads).hash == BALL_HASH


def test_pixels():
    image = rtscript.render(BALL)
    rgb = image.rgb8()
    assert rgb.shape == (48, 64, 3) and rgb.dtype == numpy.uint8
    assert (image.width, image.height) == (64, 48)
    red, green, blue = (int(channel) for channel in rgb[24, 32])
    assert red > green > blue
    assert rgb[0, 0].tolist() == [0, 0, 0]
    linear = image.linear()
    assert linear.shape == (48, 64, 3) and linear.dtype == numpy.float64
    encoded = numpy.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear.clip(0, 1) ** (1 / 2.4) - 0.055)
    assert numpy.abs(encoded.clip(0, 1) * 255 - rgb).max() <= 0.51
    assert image.rgb8_bytes() == rgb.tobytes() and image.linear_bytes() == linear.tobytes()
    rgb[0, 0] = 255
    assert image.rgb8()[0, 0].tolist() == [0, 0, 0], "an array is the caller's own"


def test_files_are_written_whole(tmp_path):
    image = rtscript.render(BALL)
    assert image.png().startswith(b"\x89PNG")
    image.save(tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes() == image.png()
    image.save(str(tmp_path / "a.ppm"))
    assert (tmp_path / "a.ppm").read_bytes() == b"P6\n64 48\n255\n" + image.rgb8_bytes()
    with pytest.raises(rtscript.Error, match="known are .png") as caught:
        image.save(tmp_path / "a.xyz")
    assert caught.value.kind == "output"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.png", "a.ppm"]


def test_parameters():
    script = rtscript.Script(
        'let r = param("r", 1.0); let on = param("on", false); let n = param("n", 1); let t = param("t", "a");'
        'print(`${r} ${on} ${n} ${t}`); sphere(0, 0, 0, r);'
    )
    lines = []
    run = script.run({"r": 0.1, "on": True, "n": 3, "t": "b c"}, print=lines.append)
    assert lines == ["0.1 true 3 b c"]
    assert run.parameters == [("r", "0.1"), ("on", "true"), ("n", "3"), ("t", "b c")]
    script.run({"r": numpy.float64(0.25), "n": numpy.int32(4)}, print=lines.append)
    assert lines[1] == "0.25 false 4 a"
    image = script.run(size=(8, 6), samples=2, seed=3).render()
    assert (image.width, image.height) == (8, 6)
    assert script.run({"r": 0.5}).scene_hash != run.scene_hash
    with pytest.raises(rtscript.Error) as caught:
        script.run({"q": 1})
    assert caught.value.code == "unknown-parameter"
    with pytest.raises(TypeError, match="a number, a boolean or a text, not list"):
        script.run({"r": [1]})
    with pytest.raises(ValueError, match="640x480"):
        script.run({"size": "wide"})


def test_errors_have_places_and_hints():
    script = rtscript.Script("light([5, 5, 5], [1, 1, 1]);\n  sphre(0, 0, 0, 1);", name="bad.rhai")
    with pytest.raises(rtscript.Error) as caught:
        script.run()
    error = caught.value
    assert (error.kind, error.code) == ("script", "unknown-function")
    assert (error.file, error.line, error.column) == ("bad.rhai", 2, 3)
    assert "sphre" in error.message and any("sphere" in hint for hint in error.hints)
    assert str(error).startswith("bad.rhai:2:3: error: ")
    assert error.diagnostics[0].source_line == "  sphre(0, 0, 0, 1);"
    assert str(pickle.loads(pickle.dumps(error))) == str(error)
    with pytest.raises(rtscript.Error) as caught:
        rtscript.Script("sphere(0, 0, 0 1);\nlet a = ;\n")
    assert [d.line for d in caught.value.diagnostics] == [1, 2]
    assert str(caught.value).count("error: ") == 2


def test_warnings_are_a_list():
    image = rtscript.render("size(8, 8); pushTransform(); sphere(0, 0, 0, 1); light([5, 5, 5], [1, 1, 1]);")
    warning = image.warnings[0]
    assert (warning.severity, warning.code, warning.line) == ("warning", "push-without-pop", 1)
    assert rtscript.render(BALL).warnings == []


def test_files_from_memory_and_below_a_folder(tmp_path):
    obj = b"v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n"
    text = 'size(16, 16); light([5, 5, 5], [1, 1, 1]); diffuse(1, 1, 1); mesh("models/a.obj");'
    (tmp_path / "models").mkdir()
    (tmp_path / "models" / "a.obj").write_bytes(obj)
    (tmp_path.parent / "outside.obj").write_bytes(obj)
    from_memory = rtscript.render(text, files={"models/a.obj": obj})
    assert from_memory.hash == rtscript.render(text, folder=tmp_path).hash
    assert from_memory.hash == rtscript.render(text, folder=tmp_path, files={}).hash
    assert from_memory.rgb8().any()
    kinds = []
    for where in ({}, {"files": {}}, {"folder": tmp_path / "models"}):
        with pytest.raises(rtscript.Error) as caught:
            rtscript.render(text, **where)
        kinds.append(caught.value.kind)
    assert kinds == ["denied", "input", "input"]
    with pytest.raises(rtscript.Error) as caught:
        rtscript.render('mesh("../outside.obj");', folder=tmp_path)
    assert caught.value.kind == "denied"


def test_pictures_that_the_script_renders():
    run = rtscript.Script(BALL + 'render("a.png"); sphere(1, 1, 0, 1); render();').run()
    (first, ball), (second, both) = run.pictures
    assert (first, second) == ("a.png", None)
    assert ball.hash == BALL_HASH != both.hash
    assert run.render().hash == both.hash
    assert not os.path.exists("a.png")


def test_untrusted_scripts_have_limits():
    text = "for i in 0..300000 { sphere(i, 0, 0, 1); } size(4, 4);"
    with pytest.raises(rtscript.Error, match="primitives") as caught:
        rtscript.Script(text, limits="untrusted").run()
    assert (caught.value.kind, caught.value.line) == ("limit", 1)
    rtscript.Script(text).run()
    with pytest.raises(ValueError, match="untrusted"):
        rtscript.Script(text, limits="none")
    with pytest.raises(ValueError, match="1024 threads"):
        rtscript.render(BALL, threads=10**6)


def test_progress_is_told_to_the_end():
    told = []
    image = rtscript.render(BALL, progress=lambda done, total: told.append((done, total)))
    assert image.hash == BALL_HASH
    assert told[-1] == (64 * 48, 64 * 48) and all(total == 64 * 48 for _, total in told)


def test_a_callback_ends_the_render():
    run = rtscript.Script(LONG).run()
    with pytest.raises(rtscript.Error) as caught:
        run.render(progress=lambda done, total: False)
    assert (caught.value.kind, caught.value.code) == ("cancelled", "cancelled")

    def fails(done, total):
        raise LookupError("from the callback")

    with pytest.raises(LookupError, match="from the callback"):
        run.render(progress=fails)
    with pytest.raises(LookupError):
        rtscript.render('loop { print("x"); }', print=lambda text: fails(0, 0))


@pytest.mark.skipif(os.name == "nt", reason="signals of its own")
@pytest.mark.parametrize("text", [LONG, "loop { }"])
def test_ctrl_c_ends_a_render_and_a_script(text):
    program = (
        "import rtscript, sys\n"
        "print('begins', flush=True)\n"
        f"try: rtscript.render({text!r})\n"
        "except KeyboardInterrupt: sys.exit(7)\n"
    )
    child = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True)
    try:
        assert child.stdout.readline() == "begins\n"
        with pytest.raises(subprocess.TimeoutExpired):
            child.wait(timeout=0.5)
        child.send_signal(signal.SIGINT)
        assert child.wait(timeout=30) == 7
    finally:
        child.kill()
        child.stdout.close()
        child.wait()


def test_threads_render_at_the_same_time():
    # Two renders that each wait for the other one to have begun: with the lock held by one, neither would end.
    barrier = threading.Barrier(2, timeout=60)
    script = rtscript.Script(BALL)
    hashes, met = [], []

    def work():
        waited = []

        def meet(done, total):
            if not waited:
                waited.append(True)
                met.append(barrier.wait())

        hashes.append(script.run().render(progress=meet, threads=1).hash)

    threads = [threading.Thread(target=work) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert hashes == [BALL_HASH] * 2 and sorted(met) == [0, 1]


def test_the_stubs_name_what_there_is():
    stub = pathlib.Path(rtscript.__file__).with_name("_rtscript.pyi")
    classes = {node.name: node for node in ast.parse(stub.read_text()).body if isinstance(node, ast.ClassDef)}
    assert sorted(classes) == ["Image", "Run", "Script"]
    for name, node in classes.items():
        described = {f.name: f for f in node.body if isinstance(f, ast.FunctionDef)}
        real = getattr(rtscript, name)
        public = {n for n in vars(real) if not n.startswith("_")} | ({"__new__"} & set(described))
        assert public == set(described), name
        for method, function in described.items():
            member = getattr(real, method)
            assert method == "__new__" or member.__doc__, f"{name}.{method}"
            if callable(member) and method != "__new__":
                args = function.args
                said = [a.arg for a in args.args + args.kwonlyargs]
                assert said == list(inspect.signature(member).parameters), f"{name}.{method}"
    assert rtscript.__doc__ and rtscript.render.__doc__ and rtscript.Error.__doc__
    shortcut = set(inspect.signature(rtscript.render).parameters) - {"text", "name", "limits"}
    assert shortcut == set(inspect.signature(rtscript.Script.run).parameters) - {"self"}
