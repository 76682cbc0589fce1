# Figures 3.1 to 3.3: the field along z at one moment (field.csv), and the path of the tip in the plane
# z = 0 over one period, seen looking back at the source (tip.csv).
width = 840
height = 400
load style

set multiplot

# left: gnuplot's x, y, z axes are the wave's z, x, y, a cyclic exchange that keeps them right-handed
set origin -0.01, -0.02
set size 0.68, 1.04
set lmargin 0
set rmargin 0
set tmargin 0
set bmargin 0
unset border
unset tics
unset grid
unset xlabel
set view 66, 30, 2.55, 1
set view equal xyz
stretch = 2.4   # length on paper of one wavelength, in units of the field
set xyplane at 0
set xrange [-0.2:5.2]
set yrange [-1.3:1.3]
set zrange [-1.3:1.3]
set arrow 1 from 0,0,0 to 5.15,0,0 head filled size 0.12,20 linecolor rgb ink linewidth 1
set arrow 2 from 0,-1.2,0 to 0,1.25,0 head filled size 0.12,20 linecolor rgb ink linewidth 1
set arrow 3 from 0,0,-1.2 to 0,0,1.25 head filled size 0.12,20 linecolor rgb ink linewidth 1
set label 1 'z' at 5.35,0,0 center textcolor rgb ink
set label 2 'x' at 0,1.42,0 center textcolor rgb ink
set label 3 'y' at 0,0,1.42 center textcolor rgb ink
splot 'field.csv' using (stretch*column('z_wavelengths')):(0):(0):(0):(column('Ex')):(column('Ey')) every 5 \
        with vectors head filled size 0.07,20 fixed linecolor rgb '#56b4e9' linewidth 1, \
      'field.csv' using (stretch*column('z_wavelengths')):'Ex':'Ey' with lines linetype 1 linewidth 2.5, \
      'tip.csv' using (0):'Ex':'Ey' with lines linecolor rgb '#d55e00' linewidth 2 dashtype solid

# right: the tip over time
unset arrow
unset label
set origin 0.66, 0
set size 0.34, 1
set lmargin 1
set rmargin 2
set size ratio -1
set xrange [-1.3:1.3]
set yrange [-1.3:1.3]
set arrow 1 from -1.25,0 to 1.25,0 head filled size screen 0.012,20 linecolor rgb ink linewidth 1
set arrow 2 from 0,-1.25 to 0,1.25 head filled size screen 0.012,20 linecolor rgb ink linewidth 1
set label 2 'x' at 1.25,-0.12 center textcolor rgb ink
set label 3 'y' at -0.12,1.25 center textcolor rgb ink
plot 'tip.csv' using 'Ex':'Ey' with lines linecolor rgb '#d55e00' linewidth 2.5 dashtype solid, \
     'arrows.csv' using 'Ex':'Ey':'dEx':'dEy' with vectors head filled size screen 0.02,22 fixed \
        linecolor rgb '#d55e00' linewidth 2.5 dashtype solid
unset multiplot
