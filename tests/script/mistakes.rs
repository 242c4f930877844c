//! Bad input: every mistake has its message, its place and, where there is one, its remedy.

use crate::host::try_run;
use rtscript::ErrorKind::{self, Input, Limit, Script as Fault};

/// A one-line script, the column, the kind, the message and the first hint (empty where there is none).
struct Case(&'static str, u32, ErrorKind, &'static str, &'static str);

#[rustfmt::skip]
const CASES: &[Case] = &[
    Case("popTransform();", 1, Fault, "popTransform without a pushTransform before it", "each popTransform() undoes one pushTransform(); remove it or add the push"),
    Case("pushTransform(); popTransform(); popTransform();", 34, Fault, "popTransform without a pushTransform before it", "each popTransform() undoes one pushTransform(); remove it or add the push"),
    Case("pushTransform(); group { popTransform(); }", 26, Fault, "popTransform without a pushTransform before it inside this block", "each popTransform() undoes one pushTransform(); remove it or add the push"),
    Case("sphere(0, 0, 0, -1);", 1, Fault, "the sphere's radius must be greater than 0 and at most 1e15, not -1", ""),
    Case("sphere(0, 0, 0, 0);", 1, Fault, "the sphere's radius must be greater than 0 and at most 1e15, not 0", ""),
    Case("sphere(0, 0, 0, 1.0 / 0.0);", 1, Fault, "sphere: radius must be a finite number, but it is infinite", "infinity comes from a division by 0.0 or a number beyond 1e308"),
    Case("sphere(0.0 / 0.0, 0, 0, 1);", 1, Fault, "sphere: center.x must be a finite number, but it is NaN", "NaN comes from 0.0 / 0.0 or the root of a negative number"),
    Case("sphere([0, 0.0 / 0.0, 0], 1);", 1, Fault, "sphere: center.y must be a finite number, but it is NaN", "NaN comes from 0.0 / 0.0 or the root of a negative number"),
    Case("sphere(1e300, 0, 0, 1);", 1, Fault, "the sphere's center must be finite numbers within 1e15", ""),
    Case("sphere(1, 2, 3);", 1, Fault, "sphere takes (center, radius), not 3 arguments", "for example sphere(0, 0, 0, 1)"),
    Case("sphere();", 1, Fault, "sphere takes (center, radius), not 0 arguments", "for example sphere(0, 0, 0, 1)"),
    Case("sphere(1, 2, 3, 4, 5, 6, 7);", 1, Fault, "sphere takes (center, radius), not 7 arguments", "for example sphere(0, 0, 0, 1)"),
    Case(r#"sphere("here", 1);"#, 1, Fault, "sphere: center must be a vector, not a string", "for example sphere(0, 0, 0, 1)"),
    Case("sphere([0, 0], 1);", 1, Fault, "sphere: center must be a vector of 3 numbers, not an array of 2", ""),
    Case(r#"sphere([0, "a", 0], 1);"#, 1, Fault, "sphere: center.y must be a number, not a string", "for example sphere(0, 0, 0, 1)"),
    Case(r#"sphere(0, "a", 0, 1);"#, 1, Fault, "sphere: center.y must be a number, not a string", "for example sphere(0, 0, 0, 1)"),
    Case("sphere([0, 0, 0], [1, 1, 1]);", 1, Fault, "sphere: radius must be a number, not an array of 3", "for example sphere(0, 0, 0, 1)"),
    Case("sphere(1, 2);", 1, Fault, "sphere: center must be a vector, not a number", "a vector is [x, y, z], vec3(x, y, z), or three numbers"),
    Case("sphere((), 1);", 1, Fault, "sphere: center must be a vector, not nothing", "a function without a result gives nothing, and so does a statement that ends with ';'"),
    Case("scale(1, 0, 1); sphere(0, 0, 0, 1);", 17, Fault, "a sphere cannot be placed under a singular matrix: it is flattened to nothing", "is a component of scale(...) 0?"),
    Case(r#"scale(0); instance("x");"#, 11, Fault, r#"no group is defined as "x""#, r#"define "x" { ... } must come first"#),
    Case("rotate(0, 0, 0, 45);", 1, Fault, "the rotation's axis is zero", "rotate([0, 1, 0], 45) turns about Y"),
    Case("rotate(1, 0, 45);", 1, Fault, "rotate takes (axis, degrees), not 3 arguments", "for example rotate(0, 1, 0, 45)"),
    Case(r#"translate("up");"#, 1, Fault, "translate: v must be a vector, not a string", "for example translate(1, 0, 0)"),
    Case("multMatrix([1, 0, 0, 0]);", 1, Fault, "multMatrix: matrix must be an array of 16 numbers, not of 4", "row by row, in one list: [1, 0, 0, x,  0, 1, 0, y,  0, 0, 1, z,  0, 0, 0, 1]"),
    Case("multMatrix([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 1]);", 1, Fault, "the matrix is not affine: its last row is [0.0, 0.0, 1.0, 1.0]", "give the 16 numbers row by row; the last row must be 0, 0, 0, 1"),
    Case(r#"multMatrix([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, "x"]);"#, 1, Fault, "multMatrix: matrix[15] must be a number, not a string", ""),
    Case("camera([0, 0, 5], [0, 0, 5], [0, 1, 0], 45);", 1, Fault, "the camera's eye and the point it looks at are the same", "camera(from, at, up, fovy): move one of the first two points"),
    Case("camera([0, 5, 0], [0, 0, 0], [0, 1, 0], 45);", 1, Fault, "the camera's up vector is parallel to the view", "[0, 1, 0] is a usual value; looking straight down, take [0, 0, -1]"),
    Case("camera([0, 0, 5], [0, 0, 0], [0, 1, 0], 180);", 1, Fault, "the field of view fovy must lie between 0 and 180 degrees, not 180", "45 is a usual value"),
    Case("camera([0, 0, 5], [0, 0, 0], [0, 1, 0], -10);", 1, Fault, "the field of view fovy must lie between 0 and 180 degrees, not -10", "45 is a usual value"),
    Case("camera([0, 0, 5], [0, 0, 0], [0, 1, 0]);", 1, Fault, "camera takes (from, at, up, fovy), not 3 arguments", "for example camera([0, 1, 5], [0, 0, 0], [0, 1, 0], 45)"),
    Case("size(0, 100);", 1, Fault, "size: width must be at least 1, not 0", ""),
    Case("size(100, -1);", 1, Fault, "size: height must be at least 1, not -1", ""),
    Case("size(100.5, 100);", 1, Fault, "size: width must be a whole number, not 100.5", ""),
    Case("size(100000, 100);", 1, Limit, "a picture of 100000 x 100 is too large: the limit 'image_side' is 32768", ""),
    Case("size(30000, 30000);", 1, Limit, "a picture of 30000 x 30000 is too large: the limit 'pixels' is 256000000", ""),
    Case("size(9223372036854775807, 1);", 1, Limit, "a picture of 4294967295 x 1 is too large: the limit 'image_side' is 32768", ""),
    Case("samples(0);", 1, Fault, "samples: n must be at least 1, not 0", ""),
    Case("samples(1000000);", 1, Limit, "1000000 samples are too many: the limit 'samples' is 65536", ""),
    Case("maxDepth(-1);", 1, Fault, "maxDepth: n must be at least 0, not -1", ""),
    Case("maxDepth(65);", 1, Limit, "65 bounces are too many: the limit 'depth' is 64", ""),
    Case(r#"encoding("sRGB");"#, 1, Fault, r#"encoding: name must be "srgb" or "raw", not "sRGB""#, r#"did you mean "srgb"?"#),
    Case(r#"encoding("hdr");"#, 1, Fault, r#"encoding: name must be "srgb" or "raw", not "hdr""#, ""),
    Case(r#"seed("x");"#, 1, Fault, "seed: n must be a whole number, not a string", "for example seed(42)"),
    Case(r##"background("#12");"##, 1, Fault, r##"background: color must be a color, and "#12" is no color code"##, r##"color codes are "#rrggbb" and "#rgb"; a color is also [red, green, blue], each from 0 to 1"##),
    Case(r#"background("red");"#, 1, Fault, r#"background: color must be a color, and "red" is no color code"#, r##"red is "#ff0000""##),
    Case("background(1);", 1, Fault, "background: color must be a color, not a number", r##"a gray is [0.5, 0.5, 0.5] or "#888""##),
    Case("background([1, 1, 1, 1]);", 1, Fault, "background: color must be a color of 3 numbers, not an array of 4", ""),
    Case("diffuse(1.0 / 0.0, 0, 0);", 1, Fault, "diffuse: color.x must be a finite number, but it is infinite", "infinity comes from a division by 0.0 or a number beyond 1e308"),
    Case("diffuse(#{ r: 1 });", 1, Fault, "diffuse: color must be a color, not a map", "for example diffuse(0.8, 0.2, 0.1)"),
    Case("shininess(-1);", 1, Fault, "shininess: s must be 0 or greater, not -1", ""),
    Case("ior(0);", 1, Fault, "ior: n must be greater than 0, not 0", "water has 1.33, glass 1.5, diamond 2.42"),
    Case("material(#{ difuse: [1, 0, 0] });", 1, Fault, r#"material: unknown key "difuse""#, "did you mean diffuse?"),
    Case("material(#{ diffuse: 1 });", 1, Fault, "material: diffuse must be a color, not a number", r##"a gray is [0.5, 0.5, 0.5] or "#888""##),
    Case(r#"material(#{ shininess: "high" });"#, 1, Fault, "material: shininess must be a number, not a string", "for example material(#{ diffuse: [0.8, 0.2, 0.1], shininess: 50 })"),
    Case("material([1, 2]);", 1, Fault, "material: options must be a map #{ }, not an array of 2", "for example material(#{ diffuse: [0.8, 0.2, 0.1], shininess: 50 })"),
    Case("checker([1, 1, 1], [0, 0, 0], 0);", 1, Fault, "checker: size must be greater than 0, not 0", ""),
    Case("light([0, 0, 0]);", 1, Fault, "light takes (position, color), not 1 argument", "for example light([5, 5, 5], [1, 1, 1])"),
    Case("light(1, 2);", 1, Fault, "light: position must be a vector, not a number", "a vector is [x, y, z], vec3(x, y, z), or three numbers"),
    Case("directional([0, 0, 0], [1, 1, 1]);", 1, Fault, "the light's direction is zero", "directional(direction, color): the direction points towards the light"),
    Case("attenuation(0, 0, 0);", 1, Fault, "the attenuation's terms must be 0 or greater and not all 0, not 0, 0, 0", "attenuation(1, 0, 0) is the default: no fall-off"),
    Case("attenuation(-1, 0, 0);", 1, Fault, "the attenuation's terms must be 0 or greater and not all 0, not -1, 0, 0", "attenuation(1, 0, 0) is the default: no fall-off"),
    Case("areaLight([0, 4, 0], [1, 0, 0], [0, 0, 1], [1, 1, 1], 0);", 1, Fault, "areaLight: n must be at least 1, not 0", ""),
    Case("areaLight([0, 4, 0], [1, 0, 0], [0, 0, 1], [1, 1, 1], 1000);", 1, Fault, "an area light has a grid of 1 to 256 points along each edge, not 1000", "areaLight(corner, edge1, edge2, color, 4) takes 16 points"),
    Case("box(1, 2);", 1, Fault, "box takes () or (w, h, d), not 2 arguments", "for example box(1, 2, 0.5)"),
    Case("box(1, -2, 1);", 1, Fault, "the box's height must be greater than 0 and at most 1e15, not -2", ""),
    Case("cylinder(0, 1);", 1, Fault, "the cylinder's radius must be greater than 0 and at most 1e15, not 0", ""),
    Case(r#"cone(1, "tall");"#, 1, Fault, "cone: height must be a number, not a string", "for example cone(0.5, 1)"),
    Case("disk(-1);", 1, Fault, "the disk's radius must be greater than 0 and at most 1e15, not -1", ""),
    Case("torus(0.1, 0.4);", 1, Fault, "the torus's minor radius must be at most its major radius of 0.1, not 0.4", "torus(major, minor): first the radius of the ring, then that of its tube"),
    Case("polygon([[0, 0, 0], [1, 0, 0]]);", 1, Fault, "a polygon needs at least 3 different points, not 2 of 2", "polygon([[0, 0, 0], [1, 0, 0], [0, 1, 0]]) is a triangle"),
    Case("polygon([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 1]]);", 1, Fault, "the polygon is not flat: points[0] is off its plane by 2.041e-1, more than 0.0001 of its extent of 1", "split it into triangles: tri(a, b, c), or mesh(#{ positions: ..., indices: ... })"),
    Case("polygon([0, 0, 0]);", 1, Fault, "polygon: points[0] must be a vector, not a number", "a vector is [x, y, z], vec3(x, y, z), or three numbers"),
    Case(r#"polygon("square");"#, 1, Fault, "polygon: points must be an array of points, not a string", "for example polygon([[0, 0, 0], [1, 0, 0], [0, 1, 0]])"),
    Case("plane(1);", 1, Fault, "plane takes (), not 1 argument", "for example plane()"),
    Case("tri([0, 0, 0], [1, 0, 0]);", 1, Fault, "tri takes (a, b, c) or (a, b, c, na, nb, nc), not 2 arguments", "for example tri([0, 0, 0], [1, 0, 0], [0, 1, 0])"),
    Case("tri([0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0], [0, 0, 1], [0, 0, 1]);", 1, Fault, "a normal of the triangle is zero", ""),
    Case(r#"instance("car");"#, 1, Fault, r#"no group is defined as "car""#, r#"define "car" { ... } must come first"#),
    Case(r#"define "car" { sphere(0, 0, 0, 1); } instance("cat");"#, 38, Fault, r#"no group is defined as "cat""#, r#"did you mean "car"?"#),
    Case(r#"define "car" { instance("car"); }"#, 16, Fault, r#"no group is defined as "car""#, r#"define "car" { ... } must come first"#),
    Case("define 3 { }", 8, Fault, "define: the name must be a string, not a number", r#"for example define "car" { box(2, 1, 4); }"#),
    Case("define car { }", 8, Fault, "unknown variable car", r#"the name of a define is a string: define "car" { ... }"#),
    Case(r#"render("");"#, 1, Fault, "render: name must not be empty", r#"for example render("picture.png")"#),
    Case("render(3);", 1, Fault, "render: name must be a string, not a number", r#"for example render("picture.png")"#),
    Case("render().pixel(640, 0);", 10, Fault, "pixel: there is no pixel (640, 0) in an image of 640 x 480", "columns and rows count from 0"),
    Case("render().depth;", 10, Fault, "an image has no property depth", "an image has .width and .height, and .pixel(x, y)"),
    Case("random(0);", 1, Fault, "random: max must be greater than min, but 0 is not greater than 0", "random() lies in [0, 1), random(max) in [0, max), random(min, max) in [min, max)"),
    Case("random(2, 1);", 1, Fault, "random: max must be greater than min, but 1 is not greater than 2", "random() lies in [0, 1), random(max) in [0, max), random(min, max) in [min, max)"),
    Case("randomInt(2, 1);", 1, Fault, "randomInt: max must not be less than min, but 1 is less than 2", ""),
    Case("randomInt(0.5, 1);", 1, Fault, "randomInt: min must be a whole number, not 0.5", ""),
    Case("normalize([0, 0, 0]);", 1, Fault, "normalize: v has no direction: it is [0, 0, 0]", ""),
    Case("vec3(1, 2).x;", 1, Fault, "vec3 takes (x, y, z) or (v), not 2 arguments", "for example vec3(1, 2, 3)"),
    Case("vec3(1, 2, 3)[3];", 14, Fault, "a vector has no component 3", "its components are [0], [1] and [2], or .x, .y and .z"),
    Case("vec3(1, 2, 3).w;", 15, Fault, "a vector has no property w", "a vector has .x .y .z"),
    Case(r#"let v = vec3(1, 2, 3); v.x = "a";"#, 26, Fault, "property x of a vector cannot be set to this", "a vector has .x .y .z, which are numbers"),
    Case("let a = [1, 2, 3]; a.x;", 22, Fault, "an array has no property x", "an array has [0] [1] [2]; vec3(x, y, z) has .x .y .z"),
    Case("vec3(1, 2, 3) + [1, 2];", 15, Fault, "an array beside a vec3 must hold 3 numbers, not 2", ""),
    Case("[1, 2, 3] * 2;", 11, Fault, "'*' does not work between an array and a number", "an array does not calculate; vec3(x, y, z) does"),
    Case(r#"[1, 2, 3] + vec3(1, 2, 3) + "x" * 2;"#, 33, Fault, "'*' does not work between a string and a number", ""),
    Case(r#""2" ** 2;"#, 5, Fault, "** takes two numbers, not a string and a number", ""),
    Case("10 ** 100;", 4, Fault, "10 ** 100 is too large for an int", "write 10.0 ** 100 for a float"),
    Case("let x = 2; x **= 3;", 14, Fault, "**= is not available: write x = x ** y", ""),
    Case("1 / 0;", 3, Fault, "division by zero: 1 / 0", ""),
    Case("9223372036854775807 + 1;", 21, Fault, "addition overflow: 9223372036854775807 + 1", ""),
    Case("let r = 1; fn ball() { sphere(0, 0, 0, r); }", 40, Fault, "unknown variable r", "a function does not see the variables outside it: give r to ball as a parameter, or declare it const and write global::r"),
    Case("shpere(0, 0, 0, 1);", 1, Fault, "unknown function shpere", "did you mean sphere?"),
    Case("push_transform();", 1, Fault, "unknown function push_transform", "did you mean pushTransform?"),
    Case("cube(1, 1, 1);", 1, Fault, "unknown function cube", "did you mean box?"),
    Case("gluLookAt(1, 2, 3);", 1, Fault, "unknown function gluLookAt", "did you mean camera?"),
    Case("quaternion(1);", 1, Fault, "unknown function quaternion", "'rtscript help' lists the functions that there are"),
    Case("sphere;", 1, Fault, "unknown variable sphere", "sphere is a function: write sphere(0, 0, 0, 1)"),
    Case("let center = [0, 0, 0]; sphere(cetner, 1);", 32, Fault, "unknown variable cetner", "did you mean center?"),
    Case("sphere(0, 0, 0, 1) sphere(1, 0, 0, 1);", 20, Fault, "expected ';' to terminate this statement", "is a ';' missing before this, or are the brackets of a call?"),
    Case("sphere(0, 0, 0, 1;", 18, Fault, "expected ',' or ')' after an argument of sphere", ""),
    Case("sphere 0 0 0 1;", 1, Fault, "unknown variable sphere", "sphere is a function: write sphere(0, 0, 0, 1)"),
    Case("for i in 5 { sphere(i, 0, 0, 1); }", 10, Fault, "expected an iterable value, not a number", "a range 0..10 runs from 0 to 9"),
    Case("for i in 0..5 { sphere(i, 0, 0, 1);", 15, Fault, "this '{' is never closed", ""),
    Case("let new = 1;", 5, Fault, "'new' is a reserved word", "give the variable another name"),
    Case("# a comment", 1, Fault, "'#' begins nothing", "comments begin with //"),
    Case(r#"let s = "open;"#, 9, Fault, "the string is not closed", "a string over several lines stands in backticks: `...`"),
    Case("if 1 { }", 4, Fault, "expected a boolean expression, not a number", "compare: x != 0"),
    Case("let m = #{ a: 1 }; m.b;", 22, Fault, r#"the map has no property "b""#, r#"whether it has one is told by "b" in map"#),
    Case("const C = 1; C = 2;", 14, Fault, "C is a constant and cannot be changed", "declare it with let"),
    Case("fn f(x) { sphere(x); } f(1, 2);", 24, Fault, "f takes (x), not 2 arguments", ""),
    Case("fn car(n) { wheel(n); } fn wheel(n) { sphere(0, 0, 0, n); } car(1); car(-1);", 39, Fault, "the sphere's radius must be greater than 0 and at most 1e15, not -1", ""),
    Case("let f = |x| sphere(0, 0, 0, x); f.call(-1);", 13, Fault, "the sphere's radius must be greater than 0 and at most 1e15, not -1", ""),
    Case("fn f(n) { f(n + 1) } f(0);", 22, Limit, "functions call one another too deep: the limit 'call_levels' is 64", "does a function that calls itself come to an end?"),
    Case(r#"throw "no such thing";"#, 1, Fault, "no such thing", ""),
    Case("throw #{ code: 1 };", 1, Fault, r#"the script threw #{"code": 1}"#, ""),
    Case("throw;", 1, Fault, "the script threw nothing", ""),
    Case(r#"import "parts" as parts;"#, 8, Input, "cannot read 'parts.rhai': no such file", ""),
    Case(r#"import "" as parts;"#, 8, Fault, "import needs the name of a file", r#"import "parts" as parts;"#),
    Case("parts::car();", 1, Fault, "no module is imported as parts", r#"import "parts" as parts;"#),
    Case(r#"eval("sphere(0, 0, 0, 1)");"#, 1, Fault, "eval is not available in scene scripts", ""),
    Case(r#"Fn("sphere").curry(1);"#, 14, Fault, "curry is not available in scene scripts", ""),
    Case("sleep(1);", 1, Fault, "unknown function sleep", "'rtscript help' lists the functions that there are"),
    Case("timestamp();", 1, Fault, "unknown function timestamp", "'rtscript help' lists the functions that there are"),
    Case("break;", 1, Fault, "break and continue only stand inside a loop", ""),
    Case("x++;", 1, Fault, "unknown variable x", "declare it first: let x = ...;"),
    Case("let i = 3; i++;", 13, Fault, "there is no operator '++'", "write x += 1"),
    Case("fn f() { fn g() { } }", 10, Fault, "a function can only be defined at the top level, not inside a block or another function", "a closure may stand anywhere: let ball = |r| sphere(0, 0, 0, r); ball.call(1);"),
    Case("clamp(1, 2, 0);", 1, Fault, "clamp: least must not exceed most, but 2 is not at most 0", ""),
    Case(r#"abs("x");"#, 1, Fault, "abs: x must be a number, not a string", "for example abs(-3)"),
    Case("sin([1]);", 1, Fault, "sin: x must be a number, not an array of 1", "for example sin(PI / 2)"),
    Case("[1, 2][5];", 8, Fault, "the array has 2 elements: there is no element 5", ""),
    Case(r#""abc"[7];"#, 7, Fault, "the string has 3 characters: there is no character 7", ""),
    Case("5.foo;", 3, Fault, "a number has no property foo", ""),
    Case("5 = 3;", 1, Fault, "only a variable can be assigned to", "== compares"),
    Case("sphere(0, 0, 0, .5);", 17, Fault, "unexpected \".\"", "a number begins with a digit: 0.5"),
    Case("let m = #{ group: 1 }; m.group;", 31, Fault, "expected '{' to start a statement block", "group { ... } holds a block of statements; nothing else can be called group"),
    Case("pushMatrix();", 1, Fault, "unknown function pushMatrix", "did you mean pushTransform?"),
    Case("this.x;", 1, Fault, "'this' can only be used in functions", ""),
    Case("print(unknown);", 7, Fault, "unknown variable unknown", "declare it first: let unknown = ...;"),
    Case(r#"parse_int("x1");"#, 1, Fault, r#""x1" is no int"#, ""),
    Case("0.0.to_int() + (1e30).to_int();", 23, Fault, "1000000000000000000000000000000 is no int", ""),];

#[test]
fn one_line_mistakes() {
    let mut wrong = Vec::new();
    for Case(source, column, kind, message, hint) in CASES {
        let Err(e) = try_run(source) else {
            wrong.push(format!("{source}\n  runs"));
            continue;
        };
        let d = e.diagnostic;
        let first = d.hints.first().map_or("", String::as_str);
        if (d.line, d.column, d.kind, &*d.message, first) != (1, *column, *kind, message, hint) {
            wrong.push(format!(
                "{source}\n  gives {}:{} {:?} {:?}\n  {first:?}",
                d.line, d.column, d.kind, d.message
            ));
        }
        assert_eq!(d.file.as_deref(), Some("scene.rhai"), "{source}");
        assert_eq!(d.source_line.as_deref(), Some(*source));
        assert!(
            !d.message.ends_with('.') && !d.message.starts_with(char::is_uppercase)
                || d.message.starts_with("C "),
            "{}",
            d.message
        );
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The error of a script of several lines.
fn error(source: &str) -> String {
    match try_run(source) {
        Ok(_) => panic!("it runs:\n{source}"),
        Err(e) => e.to_string(),
    }
}

#[test]
fn the_place_is_that_of_the_call() {
    let source = "// a comment\nlet x = 1;\n  if x == 1 {\n\tsphere(0, 0,\n      0, -1);\n}\n";
    let e = try_run(source).unwrap_err();
    assert_eq!((e.diagnostic.line, e.diagnostic.column), (4, 2));
    assert_eq!(e.diagnostic.source_line.as_deref(), Some("\tsphere(0, 0,"));
}

#[test]
fn columns_count_characters() {
    let e = try_run("print(\"äöü\"); sphere(1);").unwrap_err();
    assert_eq!(e.diagnostic.column, 15);
}

#[test]
fn calls_that_led_there_are_listed() {
    let source = "fn wheel(r) {\n  sphere(0, 0, 0, r);\n}\nfn car(r) {\n  wheel(r);\n}\nfor r in [1, 0] {\n  car(r);\n}\n";
    assert_eq!(
        error(source),
        "scene.rhai:2:3: error: the sphere's radius must be greater than 0 and at most 1e15, not 0\n  \
         note: called from car() at scene.rhai:5:3\n  \
         note: called at scene.rhai:8:3"
    );
}

#[test]
fn long_chains_of_calls_are_cut() {
    let source = "fn down(n) {\n  if n == 0 { sphere(1); }\n  down(n - 1);\n}\ndown(40);";
    let e = try_run(source).unwrap_err();
    assert_eq!(
        e.diagnostic.message,
        "sphere takes (center, radius), not 1 argument"
    );
    assert_eq!(e.diagnostic.notes.len(), 11);
    assert_eq!(e.diagnostic.notes[8], "... and 31 calls more ...");
    assert_eq!(e.diagnostic.notes[10], "called at scene.rhai:5:1");
}

#[test]
fn a_limit_inside_a_function_keeps_its_place() {
    let source = "fn deep() {\n  size(100000, 1);\n}\ndeep();";
    let e = try_run(source).unwrap_err();
    assert_eq!((e.diagnostic.line, e.diagnostic.column, e.kind()), (2, 3, Limit));
}

#[test]
fn a_long_thrown_text_is_cut() {
    let e = try_run("let s = \"x\"; s.pad(100000, 'x'); throw s;").unwrap_err();
    assert!(e.diagnostic.message.len() <= 4096);
    assert!(e.diagnostic.message.ends_with("..."));
}

#[test]
fn what_was_caught_can_be_told() {
    let source = "try { sphere(0, 0, 0, -1); } catch (e) { throw \"caught: \" + e; }";
    assert_eq!(
        try_run(source).unwrap_err().diagnostic.message,
        "caught: the sphere's radius must be greater than 0 and at most 1e15, not -1"
    );
    let source = "try { sphere(1); } catch (e) { throw e.message; }";
    assert_eq!(
        try_run(source).unwrap_err().diagnostic.message,
        "sphere takes (center, radius), not 1 argument"
    );
    let rethrown = "try {\n  sphere(0, 0, 0, -1);\n} catch (e) {\n  throw e;\n}";
    assert!(
        error(rethrown).starts_with("scene.rhai:2:3: error: the sphere's radius"),
        "{}",
        error(rethrown)
    );
}

#[test]
fn lines_beyond_the_last_that_is_counted() {
    let source = format!("{}sphere(1);", "\n".repeat(70_000));
    let e = try_run(&source).unwrap_err();
    assert_eq!(e.diagnostic.line, 65_535);
    assert_eq!(e.diagnostic.source_line, None);
    assert_eq!(
        e.diagnostic.notes,
        ["the place is at or past line 65535; lines are not counted any further"]
    );
}
