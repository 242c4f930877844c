// Glass: 25 balls and 4 boxes above a plane, two lights.
#version 3.7;
#include "view.inc"
// Branches of less weight are not followed: by POV-Ray 1/255 where nothing else is said.
#ifndef (Bailout) #declare Bailout = 1 / 255; #end
global_settings { assumed_gamma 1.0 max_trace_level 8 adc_bailout Bailout }
View(<0.3, 4.5, 10>, <0, 0.8, 0>, 38)
light_source { <10, 12, 8> rgb 0.8 }
light_source { <-9, 9, 4> rgb 0.4 }
background { rgb <0.35, 0.5, 0.75> }
#declare Glass = material {
  texture {
    pigment { rgbt <1, 1, 1, 0.9> }
    finish { ambient 0 diffuse 0 specular 0.6 roughness 0.005 reflection 0.05 }
  }
  interior { ior 1.5 }
}
plane { y, 0 texture { pigment { rgb <0.8, 0.7, 0.6> } finish { ambient 0.05 diffuse 0.8 } } }
#declare I = 0;
#while (I < 25)
  sphere { <(mod(I, 5) - 2) * 1.9, 0.9, (floor(I / 5) - 2) * 1.9>, 0.85 material { Glass } }
  #declare I = I + 1;
#end
#declare I = 0;
#while (I < 4)
  box { -0.6, 0.6 material { Glass } rotate z * 10 rotate y * 35 * I rotate x * 20 * I translate <(I - 1.5) * 2.2, 2.7, -0.4 * I> }
  #declare I = I + 1;
#end
