# Figure 3.4: one ellipse (tip.csv) with the quantities of section 3.1.2.4 (parameters.csv).
width = 560
height = 520
load style
stats 'parameters.csv' using 'E0x' nooutput name 'ex'
stats 'parameters.csv' using 'E0y' nooutput name 'ey'
stats 'parameters.csv' using 'a' nooutput name 'a'
stats 'parameters.csv' using 'b' nooutput name 'b'
stats 'parameters.csv' using 'psi_deg' nooutput name 'psi'
X = ex_max; Y = ey_max; A = a_max; B = b_max
p = psi_max * pi / 180
alpha = atan2(Y, X)
chi = atan2(B, A)
unset border
unset tics
unset grid
set size ratio -1
set xrange [-1.35:1.35]
set yrange [-1.2:1.2]
set arrow 1 from -1.3,0 to 1.3,0 head filled size screen 0.015,20 linecolor rgb ink linewidth 1
set arrow 2 from 0,-1.15 to 0,1.15 head filled size screen 0.015,20 linecolor rgb ink linewidth 1
set label 1 'x' at 1.31,-0.08 center
set label 2 'y' at -0.08,1.15 center
set object 1 rectangle from -X,-Y to X,Y fillstyle empty border linecolor rgb '#808080' linewidth 1 dashtype (6,4)
set arrow 3 from -X,-Y to X,Y nohead linecolor rgb '#808080' linewidth 1 dashtype (2,3)
set arrow 4 from 0,0 to A*cos(p),A*sin(p) head filled size screen 0.018,20 linecolor rgb '#d55e00' linewidth 2
set arrow 5 from 0,0 to -B*sin(p),B*cos(p) head filled size screen 0.018,20 linecolor rgb '#009e73' linewidth 2
set arrow 6 from -B*sin(p),B*cos(p) to A*cos(p),A*sin(p) nohead linecolor rgb '#cc79a7' linewidth 1.2 dashtype (6,4)
set label 3 'a' at 0.3*A*cos(p)-0.09*sin(p),0.3*A*sin(p)+0.09*cos(p) center textcolor rgb '#d55e00'
set label 4 'b' at -0.6*B*sin(p)-0.08,0.6*B*cos(p)-0.02 center textcolor rgb '#009e73'
set label 5 'ψ' at 0.49*cos(p/2),0.49*sin(p/2) center textcolor rgb '#d55e00'
set label 6 'α' at 0.69*cos(0.45*alpha),0.69*sin(0.45*alpha)-0.01 center textcolor rgb '#808080'
set label 7 'χ' at A*cos(p)-0.53*cos(p-0.66*chi),A*sin(p)-0.53*sin(p-0.66*chi) center textcolor rgb '#cc79a7'
set label 8 '{/sans-serif:Italic E}_{0x}' at X+0.02,-0.09 left
set label 9 '{/sans-serif:Italic E}_{0y}' at 0.03,Y+0.08 left
set parametric
set trange [0:1]
plot 'tip.csv' using 'Ex':'Ey' with lines linetype 1 linewidth 2.5, \
     0.40*cos(t*p),0.40*sin(t*p) with lines linecolor rgb '#d55e00' linewidth 1 dashtype solid, \
     0.62*cos(t*alpha),0.62*sin(t*alpha) with lines linecolor rgb '#808080' linewidth 1 dashtype solid, \
     A*cos(p)-0.44*cos(p-t*chi),A*sin(p)-0.44*sin(p-t*chi) with lines linecolor rgb '#cc79a7' linewidth 1 dashtype solid
