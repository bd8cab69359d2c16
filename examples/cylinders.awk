# Writes examples/cylinders.csv: awk -f examples/cylinders.awk
#
# The radio tower of V. Shukhov in Moscow (1922): six hyperboloids of straight struts, one on another, and rings between.
# Heights and radii in metres, struts thicker than they are. 564 cylinders.
function strut(angle0, r0, z0, angle1, r1, z1, thick) {
    printf "%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.2f\n", r0 * cos(angle0), r0 * sin(angle0), z0, r1 * cos(angle1), r1 * sin(angle1), z1,
        thick
}
function ring(r, z, n, thick,    i) {
    for (i = 0; i < n; i++) strut(i * 2 * pi / n, r, z, (i + 1) * 2 * pi / n, r, z, thick)
}
BEGIN {
    pi = atan2(0, -1)
    split("20.2 15 11.4 8.2 5.6 3.4 1.6", radius)
    print "# p0 x, y, z, p1 x, y, z, radius; awk -f examples/cylinders.awk"
    for (section = 1; section <= 6; section++) {
        n = section < 4 ? 30 : 18
        z = 25 * (section - 1)
        turn = 2 * pi * (section < 4 ? 0.15 : 0.2)
        for (i = 0; i < n; i++) {
            at = (i + section / 2) * 2 * pi / n
            strut(at, radius[section], z, at + turn, radius[section + 1], z + 25, 0.28)
            strut(at, radius[section], z, at - turn, radius[section + 1], z + 25, 0.28)
        }
        ring(radius[section], z, section < 4 ? 60 : 36, section == 1 ? 0.5 : 0.36)
    }
    ring(radius[7], 150, 18, 0.36)
    strut(0, 0, 140, 0, 0, 160, 0.5)
}
