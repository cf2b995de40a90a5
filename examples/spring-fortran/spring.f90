! A model in Fortran 2008, which `hapgrid init --lang fortran` copies, with hapgrid_model.f90, as the
! start of your own. No header of hapgrid is needed. The physics is that of examples/spring-c, line by
! line, so that the two can be compared.
!
! A bead slides on a rail along x and rests in one of two wells. The HIP pulls it by a spring that
! weakens with the HIP's distance from the rail. The state s is the bead's place, in mm. With the HIP
! at p = (x, y, z) and q = y^2 + z^2,
!
!   E(p, s) = b/4 (s^2 - a^2)^2 + k(q)/2 (x - s)^2      k(q) = k0 / (1 + q/R^2)
!   dE/ds = 0:  s^3 + P s - Q = 0                       P = k/b - a^2,  Q = k/b x
!
! With m = sqrt(-P/3), there are two stable roots, s < -m and s > m, when P < 0 and |Q| < 2 m^3;
! otherwise there is one. So the bead remembers nothing but its side: the sign of s.
module spring
  use hapgrid_model
  implicit none
  private

  integer, parameter :: state_size = 1
  integer, parameter :: beads = 3   ! the spheres that show a state: the bead, and the two wells
  integer, parameter :: dp = c_double

  type :: spring_model
    real(dp) :: wells = 10, depth = 5, stiffness = 0.25_dp, reach = 10, strength = 60
    real(dp) :: tolerance = 1e-6_dp
    real(dp) :: b = 0   ! N/mm^3
  end type

  ! What plugin() returns must live as long as the shared object is loaded.
  type(hapgrid_model_table), target, save :: table
  character(kind=c_char), target, save :: summary(64)

contains

  ! The functions of the table are not visible outside (name=''), so that shared objects do not clash.

  function model_of(handle) result(m)
    type(c_ptr), intent(in) :: handle
    type(spring_model), pointer :: m
    call c_f_pointer(handle, m)
  end function

  pure function stiffness(m, q) result(k)
    type(spring_model), intent(in) :: m
    real(dp), intent(in) :: q
    real(dp) :: k
    k = m%stiffness / (1 + q / (m%reach * m%reach))
  end function

  ! The bead's place with the HIP at p when it comes from the given side (the sign of s).
  pure function settle(m, p, right) result(s)
    type(spring_model), intent(in) :: m
    real(dp), intent(in) :: p(3)
    logical, intent(in) :: right
    real(dp) :: s, k, third, half, d, u
    k = stiffness(m, p(2) * p(2) + p(3) * p(3)) / m%b
    third = (k - m%wells * m%wells) / 3   ! P/3
    half = k * p(1) / 2                   ! Q/2
    d = half * half + third * third * third
    if (d < 0) then   ! two stable roots; |half| / sqrt(-third^3) < 1
      s = 2 * sqrt(-third) * &
        cos(acos(merge(half, -half, right) / sqrt(-third * third * third)) / 3)
      if (.not. right) s = -s
    else              ! Cardano's formula u - third/u, written so that nothing cancels
      u = (abs(half) + sqrt(d))**(1 / 3.0_dp)
      s = 0
      if (u > 0) s = 2 * half / (u * u + third + third / u * (third / u))
    end if
  end function

  pure function stretch(p, s) result(length)
    real(dp), intent(in) :: p(3), s
    real(dp) :: length
    length = sqrt((p(1) - s) * (p(1) - s) + p(2) * p(2) + p(3) * p(3))
  end function

  function create(parameters, count, error, error_size) result(handle) bind(c, name='')
    type(c_ptr), value :: parameters, error
    integer(c_size_t), value :: count, error_size
    type(c_ptr) :: handle
    type(hapgrid_parameter), pointer :: list(:)
    type(spring_model), pointer :: m
    character(len=:), allocatable :: key
    integer(c_size_t) :: i
    logical :: taken
    handle = c_null_ptr
    allocate (m)
    if (count > 0) call c_f_pointer(parameters, list, [count])
    do i = 1, count
      key = text(list(i)%key)
      select case (key)
      case ('wells');     call take(list(i), m%wells, taken)
      case ('depth');     call take(list(i), m%depth, taken)
      case ('stiffness'); call take(list(i), m%stiffness, taken)
      case ('reach');     call take(list(i), m%reach, taken)
      case ('strength');  call take(list(i), m%strength, taken)
      case ('tolerance'); call take(list(i), m%tolerance, taken)
      case default
        call fail('unknown parameter ' // key // &
          ' (known: wells, depth, stiffness, reach, strength, tolerance)', error, error_size)
        taken = .false.
      end select
      if (.not. taken) then
        deallocate (m)
        return
      end if
    end do
    m%b = 4 * m%depth / m%wells**4
    handle = c_loc(m)

  contains

    subroutine take(p, value, taken)
      type(hapgrid_parameter), intent(in) :: p
      real(dp), intent(inout) :: value
      logical, intent(out) :: taken
      real(dp) :: given
      taken = .false.
      if (p%type /= hapgrid_number) then
        call fail('parameter ' // key // ' must be a number', error, error_size)
        return
      end if
      given = number(p)
      taken = given > 0 .and. given <= huge(given)
      if (taken) then
        value = given
      else
        call fail('parameter ' // key // ' is ' // decimal(given) // ', it must be positive', &
          error, error_size)
      end if
    end subroutine
  end function

  subroutine destroy(handle) bind(c, name='')
    type(c_ptr), value :: handle
    type(spring_model), pointer :: m
    m => model_of(handle)
    deallocate (m)
  end subroutine

  subroutine info(handle, about) bind(c, name='')
    type(c_ptr), value :: handle
    type(hapgrid_model_info), intent(inout) :: about
    type(spring_model), pointer :: m
    m => model_of(handle)
    about%state_size = state_size
    about%d_max = m%reach
    about%tolerance = m%tolerance
    call put('mm', about%tolerance_unit)
    call put('mm', about%length_unit)
    call put('N mm', about%energy_unit)
    about%force_scale = 1
    about%spheres = beads
  end subroutine

  ! All states are known: one for each side, or a single one.
  function known_states(handle, x, states, capacity, count, error, error_size) &
      result(status) bind(c, name='')
    type(c_ptr), value :: handle, error
    real(dp), intent(in) :: x(3)
    integer(c_size_t), value :: capacity, error_size
    real(dp), intent(inout) :: states(capacity)   ! states(n, capacity) for a state of n numbers
    integer(c_size_t), intent(out) :: count
    integer(c_int) :: status
    type(spring_model), pointer :: m
    real(dp) :: known(2)
    m => model_of(handle)
    known = [settle(m, x, .false.), settle(m, x, .true.)]
    count = merge(2, 1, known(1) < 0 .and. known(2) > 0)
    states(1:min(count, capacity)) = known(1:min(count, capacity))
    status = 0
  end function

  ! The HIP walks in substeps that are short against the reach of the spring. Where there is one
  ! root, the bead follows it and may change sides.
  function convert(handle, s, x, d, reached, error, error_size) result(status) bind(c, name='')
    type(c_ptr), value :: handle, error
    real(dp), intent(in) :: s, x(3), d(3)         ! s(n) for a state of n numbers, reached likewise
    real(dp), intent(out) :: reached
    integer(c_size_t), value :: error_size
    integer(c_int) :: status
    type(spring_model), pointer :: m
    real(dp) :: p(3)
    integer :: k, steps
    m => model_of(handle)
    steps = ceiling(sqrt(d(1) * d(1) + d(2) * d(2) + d(3) * d(3)) / (m%reach / 64))
    reached = s
    status = 0
    do k = 1, steps
      p = x + real(k, dp) / steps * d
      reached = settle(m, p, reached >= 0)
      if (.not. stretch(p, reached) <= m%strength) then
        call fail('the spring broke: stretched to ' // decimal(stretch(p, reached)) // &
          ' mm, its strength is ' // decimal(m%strength) // ' mm', error, error_size)
        status = 1
        return
      end if
    end do
  end function

  function equal(handle, a, b) result(same) bind(c, name='')
    type(c_ptr), value :: handle
    real(dp), intent(in) :: a(state_size), b(state_size)
    integer(c_int) :: same
    type(spring_model), pointer :: m
    m => model_of(handle)
    same = merge(1, 0, all(abs(a - b) <= m%tolerance))
  end function

  ! -dE/dp at fixed s. As dE/ds = 0, it is also the slope along the branch.
  subroutine force(handle, x, s, f) bind(c, name='')
    type(c_ptr), value :: handle
    real(dp), intent(in) :: x(3), s
    real(dp), intent(out) :: f(3)
    type(spring_model), pointer :: m
    real(dp) :: k, u
    m => model_of(handle)
    k = stiffness(m, x(2) * x(2) + x(3) * x(3))
    u = x(1) - s
    f(1) = -k * u
    f(2:3) = u * u * k * k / (m%stiffness * m%reach * m%reach) * x(2:3)   ! -k'(q) u^2 = ...
  end subroutine

  function energy(handle, x, s) result(e) bind(c, name='')
    type(c_ptr), value :: handle
    real(dp), intent(in) :: x(3), s
    real(dp) :: e
    type(spring_model), pointer :: m
    m => model_of(handle)
    e = m%b / 4 * (s * s - m%wells * m%wells)**2 + &
      stiffness(m, x(2) * x(2) + x(3) * x(3)) / 2 * (x(1) - s)**2
  end function

  subroutine spheres(handle, balls) bind(c, name='')
    type(c_ptr), value :: handle
    type(hapgrid_sphere), intent(out) :: balls(beads)
    type(spring_model), pointer :: m
    integer :: i
    m => model_of(handle)
    balls(1)%radius = real(m%wells / 5, c_float)
    balls(1)%colour = [0.9_c_float, 0.9_c_float, 0.3_c_float]
    balls(2:)%radius = real(m%wells / 20, c_float)
    do i = 1, beads
      if (i > 1) balls(i)%colour = [0.4_c_float, 0.4_c_float, 0.9_c_float]
      balls(i)%label = c_null_char
    end do
  end subroutine

  subroutine shape(handle, x, s, centres) bind(c, name='')
    type(c_ptr), value :: handle
    real(dp), intent(in) :: x(3), s
    real(c_float), intent(out) :: centres(3, beads)
    type(spring_model), pointer :: m
    m => model_of(handle)
    centres = 0
    centres(1, :) = real([s, -m%wells, m%wells], c_float)
  end subroutine

  ! The one symbol that a plug-in exports.
  function plugin() result(where) bind(c, name='hapgrid_model_plugin')
    type(c_ptr) :: where
    call put('a bead between two wells, pulled by a spring (Fortran)', summary)
    table%summary = c_loc(summary)
    table%create = c_funloc(create)
    table%destroy = c_funloc(destroy)
    table%info = c_funloc(info)
    table%known_states = c_funloc(known_states)
    table%convert = c_funloc(convert)
    table%equal = c_funloc(equal)
    table%force = c_funloc(force)
    table%energy = c_funloc(energy)
    table%spheres = c_funloc(spheres)
    table%shape = c_funloc(shape)
    where = c_loc(table)
  end function
end module
