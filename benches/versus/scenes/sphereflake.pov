// Sphereflake by recursion: nine balls on each ball. 66,430 of them with Depth 5, 597,871 with 6.
#version 3.7;
#include "view.inc"
#ifndef (Depth) #declare Depth = 5; #end
global_settings { assumed_gamma 1.0 max_trace_level 5 }
View(<3.2, 2.6, 4>, <0, 0.1, 0>, 34)
light_source { <8, 10, 6> rgb 0.7 }
light_source { <-7, 6, 9> rgb 0.4 }
background { rgb <0.3, 0.45, 0.7> }
#declare Metal = texture {
  pigment { rgb <0.75, 0.6, 0.45> }
  finish { ambient 0.05 diffuse 0.6 specular 0.4 roughness 0.02 reflection 0.25 }
}
plane { y, -1.6 texture { pigment { rgb 0.6 } finish { ambient 0.05 diffuse 0.8 } } }
#macro Flake(P, R, U, V, W, D)
  sphere { P, R texture { Metal } }
  #if (D > 0)
    #local I = 0;
    #while (I < 9)
      #local Elevation = (I < 6 ? 0 : pi / 3);
      #local Azimuth = (I < 6 ? I * pi / 3 : (I - 6) * 2 * pi / 3 + pi / 6);
      #local A = U * cos(Azimuth) - W * sin(Azimuth);
      #local Out = A * cos(Elevation) + V * sin(Elevation);
      Flake(P + Out * (R * 4 / 3), R / 3, A * sin(Elevation) - V * cos(Elevation), Out, U * sin(Azimuth) + W * cos(Azimuth), D - 1)
      #local I = I + 1;
    #end
  #end
#end
Flake(<0, 0, 0>, 1, x, y, z, Depth)
