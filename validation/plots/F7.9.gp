# Figure 7.9: copper plates of 60 and 150 grit at two wavelengths: the family, a simulated scan, the best fit.
width = 840; height = 700
load style
member(w, s) = abs(column('wavelength_nm') - w) < 1 && abs(column('sigma') - s) < 1e-6 ? column('f00') : NaN
# the key is below the panels, where no curve is
of(g, w) = abs(column('grit') - g) < 1 && abs(column('wavelength_nm') - w) < 1 ? column('f00') : NaN
set multiplot
set xrange [0:80]; set xtics 20
set lmargin 10; set rmargin 2; set bmargin 4; set tmargin 3
set key at screen 0.52,0.005 center bottom horizontal maxrows 1 samplen 2
do for [row=0:1] {
  grit = row == 0 ? 60 : 150
  do for [col=0:1] {
    nm = col == 0 ? 450 : 650
    set origin 0.5*col, 0.04+0.48*(1-row); set size 0.5, 0.48
    set yrange [0:(row == 0 ? (col == 0 ? 2.5 : 4.5) : (col == 0 ? 5 : 9))]
    set title sprintf('%d grit, %d nm', grit, nm)
    set xlabel 'view zenith [deg]'
    set ylabel 'f_{00} [sr^{-1}]'
    plot for [i=3:8] 'family.csv' using 'view_deg':(member(nm, 0.025*i)) with lines linecolor rgb '#b0b0b0' linewidth 1 dashtype solid, \
      'best.csv' using 'view_deg':(of(grit, nm)) with lines linetype 1 title (row + col == 0 ? 'best fit' : ''), \
      'points.csv' using 'view_deg':(of(grit, nm)) with points linetype 2 pointtype 7 title (row + col == 0 ? 'simulated' : '')
  }
}
unset multiplot
