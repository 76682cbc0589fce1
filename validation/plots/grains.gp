# X.paint: balls of rutile in a binder of 1.5: light turned back over the diameter (grains.csv), polarisation (grains-angle.csv).
width = 900; height = 400
load style
set multiplot
set tmargin at screen 0.88; set bmargin at screen 0.21
set lmargin at screen 0.08; set rmargin at screen 0.47
set title 'light turned back, per µm of pigment'
set logscale x; set xrange [20:1000]; set xtics (20, 50, 100, 200, 500, 1000)
set xlabel 'diameter [nm]'
set yrange [0:18]; set ytics 5
set key top left Left reverse samplen 2
plot 'grains.csv' using 'diameter_nm':'450 nm' with lines title '450 nm', \
     '' using 'diameter_nm':'550 nm' with lines title '550 nm', \
     '' using 'diameter_nm':'650 nm' with lines title '650 nm'
set lmargin at screen 0.57; set rmargin at screen 0.97
set title 'polarisation across the plane, b_1/a_1'
unset logscale x; set xrange [0:180]; set xtics 45
set xlabel 'scattering angle [deg]'
set yrange [-1:1]; set ytics 0.5
set arrow 1 from 0,0 to 180,0 nohead linestyle 12
set key bottom left Left reverse samplen 2
plot 'grains-angle.csv' using 'angle_deg':'20 nm' with lines title '20 nm', \
     '' using 'angle_deg':'120 nm' with lines title '120 nm', \
     '' using 'angle_deg':'250 nm' with lines title '250 nm', \
     '' using 'angle_deg':'powder' with lines title 'powder'
unset multiplot
