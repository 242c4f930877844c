// One million balls by a loop, rendered small: what counts is how they get there.
#version 3.7;
#include "view.inc"
global_settings { assumed_gamma 1.0 }
View(<0, 60, 120>, <0, 0, 0>, 50)
light_source { <100, 200, 100> rgb 1 }
#declare Dull = texture { pigment { rgb <0.7, 0.6, 0.5> } finish { ambient 0.1 diffuse 0.7 } }
#declare I = 0;
#while (I < 1000000)
  sphere { <mod(I, 100) - 50, mod(floor(I / 100), 100) - 50, floor(I / 10000) - 50>, 0.3 texture { Dull } }
  #declare I = I + 1;
#end
