// What the adapter to 3D Systems' devices uses of OpenHaptics, for the stand-in hd.c. The values of
// constants are this stand-in's own.
#ifndef HAPGRID_STANDIN_HD_H
#define HAPGRID_STANDIN_HD_H

typedef unsigned int HHD, HDenum, HDerror, HDCallbackCode;
typedef int HDint;
typedef double HDdouble;
typedef unsigned short HDushort;
typedef const char* HDstring;
typedef unsigned long HDSchedulerHandle;
typedef struct {
  HDerror errorCode;
  int internalErrorCode;
  HHD hHD;
} HDErrorInfo;

#define HDCALLBACK
typedef HDCallbackCode(HDCALLBACK* HDSchedulerCallback)(void*);

#define HD_DEFAULT_DEVICE ((HDstring)0)
#define HD_MAX_SCHEDULER_PRIORITY 0xffff
#define HD_SUCCESS 0
#define HD_COMM_ERROR 1
#define HD_EXCEEDED_MAX_FORCE 2
#define HD_FRAME_ERROR 3
#define HD_DEVICE_ERROR(info) ((info).errorCode != HD_SUCCESS)

enum { HD_CALLBACK_DONE, HD_CALLBACK_CONTINUE };
enum {
  HD_FORCE_OUTPUT = 1,
  HD_CURRENT_POSITION,
  HD_CURRENT_FORCE,
  HD_CURRENT_BUTTONS,
  HD_MAX_WORKSPACE_DIMENSIONS,
  HD_NOMINAL_MAX_CONTINUOUS_FORCE,
  HD_DEVICE_MODEL_TYPE
};

HHD hdInitDevice(HDstring name);
void hdDisableDevice(HHD device);
void hdBeginFrame(HHD device);
void hdEndFrame(HHD device);
void hdEnable(HDenum what);
void hdGetDoublev(HDenum what, HDdouble* values);
void hdGetIntegerv(HDenum what, HDint* values);
void hdSetDoublev(HDenum what, const HDdouble* values);
HDstring hdGetString(HDenum what);
HDErrorInfo hdGetError(void);
HDstring hdGetErrorString(HDerror code);
HDSchedulerHandle hdScheduleAsynchronous(HDSchedulerCallback callback, void* data,
                                         HDushort priority);
void hdUnschedule(HDSchedulerHandle handle);
void hdStartScheduler(void);
void hdStopScheduler(void);

#endif
