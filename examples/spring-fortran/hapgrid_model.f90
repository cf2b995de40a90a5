! hapgrid's model interface (<hapgrid/plugin.h>, interface version 5) in Fortran 2008: the
! structs of the header as interoperable types, and procedures that every model in Fortran needs.
! Copy this file beside your model; spring.f90 shows how it is used. The header explains what each
! function must do.
!
! Threads: hapgrid creates one model for each thread. So a model keeps its variables in a derived
! type of its own (c_loc of it is the handle) and none in a module, or says info%processes = 1. Compile it with -frecursive:
! gfortran otherwise makes large local arrays static.
module hapgrid_model
  use, intrinsic :: iso_c_binding
  implicit none
  public

  integer(c_int32_t), parameter :: hapgrid_model_interface = 5

  ! hapgrid_parameter%type.
  integer(c_int32_t), parameter :: hapgrid_boolean = 0, hapgrid_number = 1, hapgrid_text = 2, &
    hapgrid_numbers = 3, hapgrid_texts = 4

  ! Bits of hapgrid_model_info%stored.
  integer(c_int32_t), parameter :: hapgrid_store_force = 1, hapgrid_store_shape = 2, &
    hapgrid_store_energy = 4

  type, bind(c) :: hapgrid_parameter
    type(c_ptr) :: key                     ! read it with text()
    integer(c_int32_t) :: type
    integer(c_size_t) :: count
    type(c_ptr) :: numbers                 ! double[count]: c_f_pointer(numbers, array, [count])
    type(c_ptr) :: texts                   ! char*[count]
  end type

  type, bind(c) :: hapgrid_model_info
    integer(c_int32_t) :: state_size
    integer(c_int32_t) :: stored
    real(c_double) :: d_max
    real(c_double) :: tolerance
    character(kind=c_char) :: tolerance_unit(16)   ! write the units with put()
    character(kind=c_char) :: length_unit(16)
    character(kind=c_char) :: energy_unit(16)
    character(kind=c_char) :: version(32)
    real(c_double) :: force_scale
    real(c_double) :: hip_radius
    integer(c_int32_t) :: spheres
    integer(c_int32_t) :: torsions
    integer(c_int32_t) :: processes
  end type

  type, bind(c) :: hapgrid_sphere
    real(c_float) :: radius
    real(c_float) :: colour(3)
    character(kind=c_char) :: label(8)
  end type

  type, bind(c) :: hapgrid_torsion
    integer(c_int32_t) :: spheres(4)       ! numbers of spheres, from 0
    character(kind=c_char) :: name(24)
  end type

  ! The functions as the header declares them (see spring.f90). One that a model leaves out stays null.
  type, bind(c) :: hapgrid_model_table
    integer(c_int32_t) :: interface_version = hapgrid_model_interface
    type(c_ptr) :: summary = c_null_ptr
    type(c_funptr) :: create = c_null_funptr
    type(c_funptr) :: destroy = c_null_funptr
    type(c_funptr) :: info = c_null_funptr
    type(c_funptr) :: known_states = c_null_funptr
    type(c_funptr) :: convert = c_null_funptr
    type(c_funptr) :: equal = c_null_funptr
    type(c_funptr) :: force = c_null_funptr
    type(c_funptr) :: energy = c_null_funptr
    type(c_funptr) :: spheres = c_null_funptr
    type(c_funptr) :: shape = c_null_funptr
    type(c_funptr) :: own_energy = c_null_funptr
    type(c_funptr) :: torsions = c_null_funptr
    type(c_funptr) :: check = c_null_funptr
    type(c_funptr) :: periods = c_null_funptr
  end type

contains

  ! Converts a C string to a Fortran string.
  function text(c) result(f)
    type(c_ptr), intent(in) :: c
    character(len=:), allocatable :: f
    character(kind=c_char), pointer :: letters(:)
    integer :: length, i
    call c_f_pointer(c, letters, [huge(0)])   ! the length is not known yet; no copy is made
    length = 0
    do while (letters(length + 1) /= c_null_char)
      length = length + 1
    end do
    allocate (character(len=length) :: f)
    do i = 1, length
      f(i:i) = letters(i)
    end do
  end function

  ! Writes f into a C string and ends it with NUL; what does not fit is cut off.
  subroutine put(f, c)
    character(len=*), intent(in) :: f
    character(kind=c_char), intent(out) :: c(:)
    integer :: i
    do i = 1, min(len_trim(f), size(c) - 1)
      c(i) = f(i:i)
    end do
    c(min(len_trim(f), size(c) - 1) + 1:) = c_null_char
  end subroutine

  ! Writes an error message; error and error_size are the arguments that a function of the interface
  ! gets.
  subroutine fail(message, error, error_size)
    character(len=*), intent(in) :: message
    type(c_ptr), intent(in) :: error
    integer(c_size_t), intent(in) :: error_size
    character(kind=c_char), pointer :: c(:)
    if (error_size < 1) return
    call c_f_pointer(error, c, [error_size])
    call put(message, c)
  end subroutine

  ! A number as a message shows it.
  function decimal(x) result(f)
    real(c_double), intent(in) :: x
    character(len=:), allocatable :: f
    character(len=32) :: buffer
    write (buffer, '(es13.6)') x
    f = trim(adjustl(buffer))
  end function

  ! The number of a parameter whose type is hapgrid_number.
  function number(p) result(x)
    type(hapgrid_parameter), intent(in) :: p
    real(c_double) :: x
    real(c_double), pointer :: x_pointer
    call c_f_pointer(p%numbers, x_pointer)
    x = x_pointer
  end function
end module
