// A mesh with smooth normals, one light. model.inc holds it, fitted into a ball of radius 1.
#version 3.7;
#include "view.inc"
#include "model.inc"
global_settings { assumed_gamma 1.0 max_trace_level 5 }
View(<1.17, 0.91, 2.13>, <0, 0, 0>, 44)
light_source { <2, 3, 1.5> rgb 1 }
background { rgb <0.3, 0.4, 0.6> }
object {
  Model
  texture { pigment { rgb <0.75, 0.7, 0.6> } finish { ambient 0.05 diffuse 0.8 specular 0.3 roughness 0.025 } }
}
