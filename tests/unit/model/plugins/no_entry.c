/* A shared object, but no plug-in. */
int hapgrid_model_plug(void);

int hapgrid_model_plug(void) { return 0; }
