// An area light of 8 by 8 jittered samples over 26 balls and boxes.
#version 3.7;
#include "view.inc"
global_settings { assumed_gamma 1.0 max_trace_level 5 }
View(<0, 5, 11>, <0, 0.7, 0>, 34)
light_source { <6, 10, 6> rgb 1 area_light <4, 0, 0>, <0, 0, 4>, 8, 8 jitter }
background { rgb <0.3, 0.4, 0.6> }
plane { y, 0 texture { pigment { rgb 0.8 } finish { ambient 0.05 diffuse 0.8 } } }
#declare I = 0;
#while (I < 26)
  #declare A = I * 2.399963;
  #declare R = 0.85 * sqrt(I);
  #if (mod(I, 3) = 0)
    box { <-0.4, 0, -0.4>, <0.4, 1.3, 0.4> rotate y * I * 17 translate <R * cos(A), 0, R * sin(A)>
      texture { pigment { rgb <0.8, 0.4, 0.3> } finish { ambient 0.05 diffuse 0.8 } } }
  #else
    sphere { <R * cos(A), 0.5, R * sin(A)>, 0.5
      texture { pigment { rgb <0.3, 0.5, 0.8> } finish { ambient 0.05 diffuse 0.8 specular 0.3 roughness 0.05 } } }
  #end
  #declare I = I + 1;
#end
