# Figure 3.7: ellipses (73 points each, 7 values of psi for each of 7 values of chi) against psi and chi.
width = 820
height = 620
load style
set border 3
unset grid
set xrange [-20:205]
set yrange [-62:62]
set xtics 30
set ytics -45, 15, 45
set format x '%g°'
set format y '%g°'
set xlabel 'orientation ψ'
set ylabel 'ellipticity χ'
# one unit of the field in degrees of either axis, so that circles stay round (plot box 680 x 520, about)
kx = 10
ky = kx * (124.0 / 225) * (720.0 / 540)
right = '#0072b2'
left = '#d55e00'
hue(chi) = chi > 0 ? 0x0072b2 : (chi < 0 ? 0xd55e00 : 0x333333)
set label 1 'right-handed' at graph 1.03, first 58 right textcolor rgb right
set label 2 'left-handed' at graph 1.03, first -58 right textcolor rgb left
set label 3 'linear' at graph 1.03, first 5 right textcolor rgb ink
plot for [k=0:48] 'ellipses.csv' every ::(73*k)::(73*k+72) \
       using (column('psi_deg')+kx*column('Ex')):(column('chi_deg')+ky*column('Ey')):(hue(column('chi_deg'))) \
       with lines linecolor rgb variable linewidth 2 dashtype solid, \
     for [k=0:48] 'ellipses.csv' every ::(73*k+10)::(73*k+10) \
       using (column('psi_deg')+kx*column('Ex')):(column('chi_deg')+ky*column('Ey')):(column('chi_deg') != 0 ? kx*column('dEx') : NaN):(ky*column('dEy')):(hue(column('chi_deg'))) \
       with vectors head filled size screen 0.011,25 fixed linecolor rgb variable linewidth 2
