# Writes examples/spheres.csv: awk -f examples/spheres.awk
#
# The sphereflake of E. Haines, "A proposal for standard graphics environments", IEEE Computer Graphics and Applications 7(11),
# 1987: nine spheres of a third of the radius stand around each, six about its equator and three above. 820 spheres.
function place(x, y, z, r, ax, ay, az, level,    length_, ux, uy, uz, vx, vy, vz, i, angle, height, wide, dx, dy, dz, q) {
    printf "%.5f,%.5f,%.5f,%.5f\n", x, y, z, r
    if (level == 0) return
    # u and v stand at right angles to the axis a
    if (az * az < 0.81) { ux = -ay; uy = ax; uz = 0 } else { ux = 0; uy = -az; uz = ay }
    length_ = sqrt(ux * ux + uy * uy + uz * uz)
    ux /= length_; uy /= length_; uz /= length_
    vx = ay * uz - az * uy; vy = az * ux - ax * uz; vz = ax * uy - ay * ux
    for (i = 0; i < 9; i++) {
        angle = i < 6 ? i * pi / 3 : pi / 6 + (i - 6) * 2 * pi / 3
        height = i < 6 ? 0 : sqrt(2 / 3); wide = sqrt(1 - height * height)
        dx = wide * (cos(angle) * ux + sin(angle) * vx) + height * ax
        dy = wide * (cos(angle) * uy + sin(angle) * vy) + height * ay
        dz = wide * (cos(angle) * uz + sin(angle) * vz) + height * az
        q = r * 4 / 3
        place(x + q * dx, y + q * dy, z + q * dz, r / 3, dx, dy, dz, level - 1)
    }
}
BEGIN {
    pi = atan2(0, -1)
    print "# centre x, y, z, radius; awk -f examples/spheres.awk"
    place(0, 0, 0, 1, 0.1428571, -0.2857143, 0.9476071, 3)
}
